"""The laws of the pump joint that have become generic, as they were written for it alone: no number may move."""

from __future__ import annotations

from math import exp, expm1, pi, sin, sqrt

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class CrossLeakage(Effect):
    subsystem = "lines"
    conductance = Parameter("m^3/(s*Pa)", 2e-15, (0.0, 1e-11), text="flow for each pascal of difference", off=0.0)

    @staticmethod
    def cross_flow(pressure1, pressure2, conductance):
        return conductance * (pressure1 - pressure2)


class EncoderBias(Effect):
    subsystem = "sensors"
    bias = Parameter("rad", 0.02, (-0.4, 0.4), text="reading at true angle 0", off=0.0)

    @staticmethod
    def arm_reading(bias):
        return bias


class EncoderEccentricity(Effect):
    subsystem = "sensors"
    amplitude = Parameter("rad", 0.03, (0.0, 0.4), text="eccentricity over radius", off=0.0)
    phase = Parameter("rad", 0.0, (-3.15, 3.15), text="angle of the eccentricity", shape=True)
    zeroed = Parameter("1", 1.0, (0.0, 1.0), text="share of the error at the arm's zero that was set to zero there")

    @staticmethod
    def arm_reading(arm_angle, amplitude, phase, zeroed):
        return amplitude * (sin(arm_angle + phase) - zeroed * sin(phase))


class EncoderLag(Effect):
    subsystem = "sensors"
    lag = Parameter("s", 0.005, (0.0001, 0.2), "log-uniform", "time by which the angle is late", off=0.0)
    dead_share = Parameter("1", 0.25, (0.0, 0.5), text="0: a first-order lag, 0.5: a dead time")
    lagged_angle = State("rad", 1e-06, 0.1, text="angle that the encoder has caught up with")

    @staticmethod
    def start_lagged_angle(arm_angle):
        return arm_angle

    @staticmethod
    def d_lagged_angle(arm_angle, lagged_angle, lag, dead_share):
        return (arm_angle - lagged_angle) / (lag * (1.0 - dead_share))

    @staticmethod
    def arm_reading(arm_reading, arm_angle, lagged_angle, dead_share):
        return lagged_angle + dead_share / (1.0 - dead_share) * (lagged_angle - arm_angle)


class EntrainedAir(Effect):
    subsystem = "lines"
    air_volume = Parameter(
        "m^3", 8.5e-09, (0.0, 3e-07), text="air of one line at atmospheric pressure (0.5 %: 8.5 mm3)", off=0.0
    )

    @staticmethod
    def stiffness1(stiffness1, pressure1, air_volume):
        absolute = max(pressure1 + 101325.0, 1000.0)
        return stiffness1 / (1.0 + stiffness1 * air_volume * 101325.0 / (absolute * absolute))

    @staticmethod
    def stiffness2(stiffness2, pressure2, air_volume):
        absolute = max(pressure2 + 101325.0, 1000.0)
        return stiffness2 / (1.0 + stiffness2 * air_volume * 101325.0 / (absolute * absolute))


class FrictionDrift(Effect):
    subsystem = "joint"
    drift = Parameter("1/s", 0.05, (-1.0, 2.0), text="share of friction gained in each second at first", off=0.0)
    settling_time = Parameter(
        "s", 10.0, (0.2, 100.0), "log-uniform", "time after which the rate has fallen to 37 %", shape=True
    )
    pace = Parameter("m/s", 1.0, (0.001, 1.0), "log-uniform", "speed at which travel counts as much as time", shape=True)
    travelled = State("m", 1e-06, 0.01, text="travel since the start of the command")
    last_position = State("m", 1e-06, 0.01, text="travel of the sliders one sample ago")

    @staticmethod
    def start_last_position(slider_position):
        return slider_position

    @staticmethod
    def next_travelled(travelled, last_position, slider_position, time):
        return travelled + abs(slider_position - last_position) if time > 0.0 else 0.0

    @staticmethod
    def next_last_position(slider_position):
        return slider_position

    @staticmethod
    def friction_static(friction_static, time, travelled, drift, settling_time, pace):
        progress = max(time, 0.0) + travelled / pace
        return friction_static * max(0.05, 1.0 + drift * settling_time * (1.0 - exp(-progress / settling_time)))

    @staticmethod
    def friction_coulomb(friction_coulomb, time, travelled, drift, settling_time, pace):
        progress = max(time, 0.0) + travelled / pace
        return friction_coulomb * max(0.05, 1.0 + drift * settling_time * (1.0 - exp(-progress / settling_time)))


class Leakage(Effect):
    subsystem = "lines"
    conductance = Parameter("m^3/(s*Pa)", 2e-16, (0.0, 1e-11), text="flow for each pascal of line pressure", off=0.0)
    threshold = Parameter("Pa", 590000.0, (0.0, 2000000.0), text="pressure above which the fittings open", shape=True)
    conductance_above = Parameter("m^3/(s*Pa)", 3.9e-14, (0.0, 1e-11), text="further flow per pascal above it", off=0.0)

    @staticmethod
    def leak1(pressure1, conductance, threshold, conductance_above):
        return conductance * pressure1 + conductance_above * max(pressure1 - threshold, 0.0)

    @staticmethod
    def leak2(pressure2, conductance, threshold, conductance_above):
        return conductance * pressure2 + conductance_above * max(pressure2 - threshold, 0.0)


class PositionFriction(Effect):
    subsystem = "joint"
    amplitude = Parameter("1", 0.2, (0.0, 0.9), text="largest change of friction over its mean", off=0.0)
    period = Parameter(
        "rad", 6.283185307179586, (0.3, 6.3), "log-uniform", "arm angle of one period, a turn or less", shape=True
    )
    phase = Parameter("rad", 0.0, (-3.15, 3.15), text="phase at arm angle 0", shape=True)

    concentration = Parameter("1", 0.0, (-6.0, 6.0), text="0: a sine; above, a bump; below, a dip")

    @staticmethod
    def friction_static(friction_static, slider_angle, amplitude, period, phase, concentration):
        k = concentration if abs(concentration) > 1e-6 else 1e-6
        return friction_static * (
            1.0 + amplitude * expm1(k * sin(2.0 * pi * slider_angle / period + phase)) * abs(k) / (k * expm1(abs(k)))
        )

    @staticmethod
    def friction_coulomb(friction_coulomb, slider_angle, amplitude, period, phase, concentration):
        k = concentration if abs(concentration) > 1e-6 else 1e-6
        return friction_coulomb * (
            1.0 + amplitude * expm1(k * sin(2.0 * pi * slider_angle / period + phase)) * abs(k) / (k * expm1(abs(k)))
        )


class Presliding(Effect):
    subsystem = "joint"
    compliance = Parameter("m/N", 1e-05, (2e-06, 0.0002), "log-uniform", "mean deflection for each newton", shape=True, off=0.0)
    fall_velocity = Parameter(
        "m/s",
        0.0005,
        (5e-05, 0.02),
        "log-uniform",
        "slip at which half of the extra static friction is gone",
        shape=True,
        off=0.0,
    )
    lateness = Parameter("1", 16.0, (0.0, 40.0), text="0: friction falls with any motion; large: with full slip only")
    deflection = State("m", 2e-08, 1e-05, text="deflection of the middle bristles", known=True)
    stiff_deflection = State("m", 2e-08, 1e-05, text="deflection of the stiff bristles", known=True)
    soft_deflection = State("m", 2e-08, 1e-05, text="deflection of the soft bristles", known=True)
    weakness = State("1", 0.01, 1.0, text="share of the extra static friction that slip has taken", known=True)

    @staticmethod
    def start_deflection(push, slider_velocity, speed, friction_static, friction_coulomb, compliance):
        sliding = friction_coulomb if slider_velocity > 0.0 else -friction_coulomb
        resting = max(-friction_static, min(friction_static, push))
        return compliance * (sliding if speed > 0.0 else resting)

    @staticmethod
    def start_stiff_deflection(push, slider_velocity, speed, friction_static, friction_coulomb, compliance):
        sliding = friction_coulomb if slider_velocity > 0.0 else -friction_coulomb
        resting = max(-friction_static, min(friction_static, push))
        return 0.2 * compliance * (sliding if speed > 0.0 else resting)

    @staticmethod
    def start_soft_deflection(push, slider_velocity, speed, friction_static, friction_coulomb, compliance):
        sliding = friction_coulomb if slider_velocity > 0.0 else -friction_coulomb
        resting = max(-friction_static, min(friction_static, push))
        return 1.8 * compliance * (sliding if speed > 0.0 else resting)

    @staticmethod
    def start_weakness(speed):
        return 1.0 if speed > 0.0 else 0.0

    @staticmethod
    def d_deflection(deflection, weakness, slider_velocity, friction_static, friction_coulomb, compliance):
        level = friction_static - (friction_static - friction_coulomb) * weakness
        share = deflection / (compliance * level)
        return slider_velocity * (1.0 - (share * share if slider_velocity * share > 0.0 else 0.0))

    @staticmethod
    def d_stiff_deflection(stiff_deflection, weakness, slider_velocity, friction_static, friction_coulomb, compliance):
        level = friction_static - (friction_static - friction_coulomb) * weakness
        share = stiff_deflection / (0.2 * compliance * level)
        return slider_velocity * (1.0 - (share * share if slider_velocity * share > 0.0 else 0.0))

    @staticmethod
    def d_soft_deflection(soft_deflection, weakness, slider_velocity, friction_static, friction_coulomb, compliance):
        level = friction_static - (friction_static - friction_coulomb) * weakness
        share = soft_deflection / (1.8 * compliance * level)
        return slider_velocity * (1.0 - (share * share if slider_velocity * share > 0.0 else 0.0))

    @staticmethod
    def d_weakness(
        deflection,
        stiff_deflection,
        soft_deflection,
        weakness,
        speed,
        friction_static,
        friction_coulomb,
        moving_mass,
        compliance,
        fall_velocity,
        lateness,
    ):
        level = friction_static - (friction_static - friction_coulomb) * weakness
        force = (deflection + stiff_deflection / 0.2 + soft_deflection / 1.8) / (3.0 * compliance)
        slip = speed * min(abs(force) / level, 1.0) ** lateness
        return (slip * slip / (slip * slip + fall_velocity * fall_velocity) - weakness) / (
            2.0 * pi * sqrt(moving_mass * compliance)
        )

    @staticmethod
    def friction_locks(friction_locks):
        return 0.0 * friction_locks

    @staticmethod
    def friction(
        friction,
        deflection,
        stiff_deflection,
        soft_deflection,
        weakness,
        slider_velocity,
        friction_static,
        friction_coulomb,
        friction_viscous,
        moving_mass,
        compliance,
    ):
        level = friction_static - (friction_static - friction_coulomb) * weakness
        force = (deflection + stiff_deflection / 0.2 + soft_deflection / 1.8) / (3.0 * compliance)
        share = force / level
        elastic = slider_velocity * (1.0 - (min(share * share, 1.0) if slider_velocity * share > 0.0 else 0.0))
        damping = 2.0 * sqrt(moving_mass / compliance) * (1.0 - weakness)
        return force + damping * elastic + friction_viscous * slider_velocity


class StaticFrictionAgeing(Effect):
    subsystem = "joint"
    growth = Parameter("1", 0.4, (0.0, 4.0), text="growth of static friction after a long rest", off=0.0)
    half_time = Parameter("s", 0.3, (0.005, 30.0), "log-uniform", "rest after which half of it has come", shape=True)
    rest_before = Parameter("s", 2.0, (0.01, 1000.0), "log-uniform", "rest before the log began", shape=True)
    rest_began = State("s", 1e-06, 1.0, text="time at which the slider came to rest")

    @staticmethod
    def start_rest_began(time, rest_before):
        return time - rest_before

    @staticmethod
    def next_rest_began(rest_began, speed, time):
        return rest_began if speed < 1e-05 else time

    @staticmethod
    def friction_static(friction_static, time, rest_began, growth, half_time):
        rest = max(time - rest_began, 0.0)
        return friction_static * (1.0 + growth * rest / (rest + half_time))


class StribeckFriction(Effect):
    subsystem = "joint"
    stribeck_velocity = Parameter(
        "m/s",
        0.006,
        (0.0005, 0.05),
        "log-uniform",
        "speed at which the extra friction has fallen to 37 %",
        shape=True,
        off=0.0,
    )

    @staticmethod
    def friction_coulomb(friction_coulomb, friction_static, speed, stribeck_velocity):
        return friction_coulomb + (friction_static - friction_coulomb) * exp(-((speed / stribeck_velocity) ** 2))


BEFORE: dict[str, type[Effect]] = {
    "cross_leakage": CrossLeakage,
    "encoder_bias": EncoderBias,
    "encoder_eccentricity": EncoderEccentricity,
    "encoder_lag": EncoderLag,
    "entrained_air": EntrainedAir,
    "friction_drift": FrictionDrift,
    "leakage": Leakage,
    "position_friction": PositionFriction,
    "presliding": Presliding,
    "static_friction_ageing": StaticFrictionAgeing,
    "stribeck_friction": StribeckFriction,
}
