// A rig on a serial line (docs/rig_protocol.md): one position in m from an encoder on pins 2 and 3, one voltage by PWM on pin 9.
// Not tried on a board: look at every line, try it with the drive switched off.
const double PERIOD = 0.005, WATCHDOG = 0.05;      // s; the plant's period must be the same
const double METRES_PER_COUNT = 1e-5, VOLTS = 10.0; // full PWM is 10 V; pin 8 says the direction
volatile long counts = 0;
unsigned long number = 0, nextUs = 0, writtenMs = 0;
bool moving = false, tripped = false;
char line[96];
byte length = 0;

void edge() { counts += digitalRead(2) == digitalRead(3) ? 1 : -1; }

void put(double volts) {
  if (!(volts >= -VOLTS && volts <= VOLTS)) volts = 0.0;  // nan, too
  digitalWrite(8, volts < 0.0);
  analogWrite(9, (int)(255.0 * fabs(volts) / VOLTS));
}

void safe() { put(0.0); moving = false; }

void say(String text) {
  byte sum = 0;
  for (unsigned i = 0; i < text.length(); i++) sum ^= (byte)text[i];
  char end[5];
  snprintf(end, sizeof end, "*%02X\n", sum);
  Serial.print(text);
  Serial.print(end);
}

void obey() {
  char *star = strrchr(line, '*');
  byte sum = 0;
  if (star == NULL || strlen(star) != 3) { say("E no message"); return; }
  for (char *at = line; at < star; at++) sum ^= (byte)*at;
  if (sum != strtoul(star + 1, NULL, 16)) { say("E wrong check sum"); return; }
  *star = 0;
  switch (line[0]) {
    case 'H': safe(); tripped = false;
      say("H 1 " + String(PERIOD, 6) + " " + String(WATCHDOG, 3) + " 1 position_m voltage"); break;
    case 'R': {
      while ((long)(micros() - nextUs) < 0) watch();
      nextUs += (unsigned long)(PERIOD * 1e6); number++;
      noInterrupts(); long now = counts; interrupts();
      if (tripped) say("E the watchdog has tripped");
      else say("S " + String(number) + " " + String(now * METRES_PER_COUNT, 7));
      break; }
    case 'W': if (!tripped) { put(atof(line + 1)); writtenMs = millis(); moving = true; } break;
    case 'Z': safe(); tripped = false; say("Z"); break;
    default: say("E unknown message");
  }
}

void watch() {
  if (moving && millis() - writtenMs > (unsigned long)(WATCHDOG * 1e3)) { safe(); tripped = true; }
}

void setup() {
  pinMode(2, INPUT_PULLUP); pinMode(3, INPUT_PULLUP); pinMode(8, OUTPUT); pinMode(9, OUTPUT);
  attachInterrupt(digitalPinToInterrupt(2), edge, CHANGE);
  safe();
  Serial.begin(115200);
  nextUs = micros();
}

void loop() {
  watch();
  while (Serial.available()) {
    char one = Serial.read();
    if (one == '\n') { line[length] = 0; obey(); length = 0; }
    else if (length < sizeof line - 1) line[length++] = one;
  }
}
