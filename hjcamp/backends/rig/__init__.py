"""The rig: what moves it, watches it and stops it, on the hardware of National Instruments or its virtual copy."""
