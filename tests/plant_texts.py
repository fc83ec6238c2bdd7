"""Files of plants that tests write into a folder."""

TANKS = '''"""Two tanks, one above the other."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, sqrt, store


class Tanks(Plant):
    """A pump fills the upper one of two tanks, which runs out into the lower one."""

    upper = State("V", typical=5.0, low=0.0, start="unknown")
    lower = State("V", typical=5.0, low=0.0)
    pump = Input("V", typical=3.0)
    k1 = Parameter("V**0.5/s", 0.05, (1e-4, 1.0), "log-uniform", base=True)
    k3 = Parameter("V**0.5/s", 0.05, (1e-4, 1.0), "log-uniform", base=True)
    k4 = Parameter("1/s", 0.05, (1e-4, 1.0), "log-uniform", base=True)
    level_v = Measured("gauge", of="lower")

    @staticmethod
    def equations(state, parameter, drive, rate):
        inflow = actuator(parameter.k4 * drive.pump)
        between = path(parameter.k1 * sqrt(state.upper), upstream=state.upper, downstream=state.lower)
        outflow = path(parameter.k3 * sqrt(state.lower), upstream=state.lower)
        rate.upper = store(inflow - between)
        rate.lower = store(between - outflow)
        gauge = sensor(state.lower)
'''
ROTOR = """'''A vessel under pressure that turns an arm.'''
from hjcamp.plant import Input, Measured, Parameter, Plant, State
from hjcamp.plant import actuator, body, contact, outside, path, sensor, store, transmission


class Rotor(Plant):
    '''A vessel under pressure turns an arm.'''

    pressure = State("Pa", typical=1e5, low=-9e4)
    angle = State("rad", typical=1.0)
    speed = State("rad/s", typical=2.0)
    flow = Input("m^3/s", typical=1e-5)
    stiffness = Parameter("Pa/m^3", 1e11)
    volume = Parameter("m^3", 1e-6)
    gap = Parameter("m^3/(s*Pa)", 1e-11)
    inertia = Parameter("kg*m^2", 0.05, base=True)
    coulomb = Parameter("N*m", 0.03, base=True)
    static = Parameter("N*m", 0.05, base=True)
    viscous = Parameter("N*m*s", 0.01, base=True)
    angle_deg = Measured("encoder", of="angle")

    @staticmethod
    def equations(state, parameter, drive, rate):
        inflow = actuator(drive.flow)
        drain = path(parameter.gap * state.pressure, upstream=state.pressure)
        rate.pressure = store(inflow - drain - parameter.volume * state.speed, stiffness=parameter.stiffness)
        load = outside("N*m")
        torque = parameter.volume * state.pressure
        rub = contact(state.speed, torque + load, coulomb=parameter.coulomb, static=parameter.static,
                      viscous=parameter.viscous, travel=state.angle, load=torque)
        rate.angle = state.speed
        rate.speed = body(torque + load - rub, parameter.inertia, load=load, position=state.angle)
        arm = transmission(state.angle)
        encoder = sensor(arm)
"""
PRESS = """'''A cylinder at the end of a pipe lifts a weight by a lever.'''
from hjcamp.plant import Input, Measured, Parameter, Plant, State
from hjcamp.plant import body, contact, line, outside, sensor, signal, store, transmission


class Press(Plant):
    '''A piston is pushed through a pipe by a pump whose travel is measured; a lever shows its travel.'''

    pressure = State("Pa", typical=1e5, low=-9e4)
    travel = State("m", typical=0.02)
    speed = State("m/s", typical=0.05)
    pump = Input("m", typical=0.02, hold="linear", field="pump_mm")
    pump_speed = Input("m/s", typical=0.1, rate_of="pump")
    shaking = Input("V", typical=2.0)
    area = Parameter("m^2", 1e-3)
    stiffness = Parameter("Pa/m^3", 1e10, base=True)
    mass = Parameter("kg", 8.0)
    gravity = Parameter("m/s^2", 9.81)
    radius = Parameter("m", 0.1)
    coulomb = Parameter("N", 5.0, base=True)
    viscous = Parameter("N*s/m", 30.0, base=True)
    lever_deg = Measured("dial")
    pressure_kpa = Measured("gauge", of="pressure")

    @staticmethod
    def equations(state, parameter, drive, rate):
        driver = transmission(drive.pump_speed)
        flow = signal(parameter.area * state.speed, "m^3/s", "flow into the cylinder")
        rate.pressure = store(parameter.area * driver - flow, stiffness=parameter.stiffness)
        end = line(state.pressure, flow=flow)
        turn = signal(state.travel / parameter.radius, "rad", "angle of the lever")
        extra = outside("N")
        push = parameter.area * end
        weight = parameter.mass * parameter.gravity
        rub = contact(state.speed, push=push - weight + extra, coulomb=parameter.coulomb, viscous=parameter.viscous,
                      dither=drive.shaking)
        rate.travel = state.speed
        rate.speed = body(push - weight + extra - rub, parameter.mass, load=extra, position=state.travel, angle=turn)
        lever = transmission(turn, torque=rub * parameter.radius)
        dial = sensor(lever)
        gauge = sensor(state.pressure)
"""
SLAB = '''"""A block that is heated."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor


class Slab(Plant):
    """A block that cools to a room at 0."""

    warmth = State("K", typical=20.0)
    power = Input("W", typical=50.0)
    capacity = Parameter("J/K", 200.0)
    loss = Parameter("W/K", 2.0, (0.01, 100.0), "log-uniform", base=True)
    period = 1.0
    warmth_k = Measured("probe", of="warmth")

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.warmth = (drive.power - parameter.loss * state.warmth) / parameter.capacity
        probe = sensor(state.warmth)
'''
