"""The generic effects that the pump joint calls by names of its own, with its numbers: units, defaults and bounds in SI."""

from __future__ import annotations

from hjcamp.model.declare.instance import Instance
from hjcamp.model.declare.parameter import Parameter, State


class CrossLeakage(Instance):
    r"""Water passes from the line of higher pressure to the other one, in proportion to the difference.

    .. math:: q_{12} = G\,(p_1 - p_2)

    Seen as: the pressure difference decays while the sum of the pressures stays.
    Not for: loss to the outside, where the sum falls (see leakage), or pistons that slip (see pump_backlash).
    Source: laminar leakage flow, Merritt (1967), Hydraulic Control Systems, section 3.2; thesis 4.4.3.15.
    """

    of = "cross_leakage"
    at = {"crossing": {}}  # noqa: RUF012
    conductance = Parameter("m^3/(s*Pa)", 2e-15, (0.0, 1e-11), text="flow for each pascal of difference", off=0.0)


class DitherRelief(Instance):
    r"""Dither keeps the seals trembling, so they break away earlier and slide more easily.

    .. math:: F_s \leftarrow F_s\,\max(1 - r_s |u_d|,\ 0.05), \quad F_c \leftarrow \min(F_c\,\max(1 - r_c |u_d|,\ 0.05),\ F_s)

    with u_d the dither voltage of the sample; a square wave, so that its size is constant.
    Seen as: less friction in tests with dither than in tests without, most of all at breakaway.
    Not for: tests that all have the same dither (static and Coulomb friction take it up), or logs without dither_v.
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138,
    doi:10.1016/0005-1098(94)90209-7 (dither); thesis 5.2.
    """

    of = "dither_relief"
    at = {"seal": {}}  # noqa: RUF012
    static_relief = Parameter("1/V", 0.2, (0.0, 0.8), text="share of static friction taken away by each volt", off=0.0)
    coulomb_relief = Parameter("1/V", 0.1, (0.0, 0.8), text="share of Coulomb friction taken away by each volt", off=0.0)


class EncoderBias(Instance):
    r"""The arm encoder was set to zero at a wrong angle.

    .. math:: \theta_m = \theta_a + b

    Seen as: a constant angle error. The motion shows it only through what depends on the true angle
    (gravity_load, position_friction), or where the true angle at the start is known.
    Not for: an error that changes with the angle (see encoder_eccentricity).
    Source: thesis 3.7 (incremental encoder, zero set before each test).
    """

    of = "sensor_offset"
    at = {"encoder": {"offset": "bias"}}  # noqa: RUF012
    bias = Parameter("rad", 0.02, (-0.4, 0.4), text="reading at true angle 0", off=0.0)


class EncoderEccentricity(Instance):
    r"""The encoder's magnet sits off the axis, so its error comes back with each turn.

    .. math:: \theta_m = \theta_a + e\,\bigl(\sin(\theta_a + \varphi) - z\,\sin\varphi\bigr)

    no error at the arm's zero where the encoder was set to zero there (z = 1).
    Seen as: an angle error that depends on arm angle alone, at rest and in motion, in both directions.
    Not for: an error that depends on speed (see encoder_lag) or none (see encoder_bias).
    Source: eccentricity e / R of a ring encoder, e.g. Ellin & Dolsak (2008), Sensor Review 28(2), 150-158; thesis 3.7.
    """

    of = "eccentricity"
    at = {"encoder": {}}  # noqa: RUF012
    amplitude = Parameter("rad", 0.03, (0.0, 0.4), text="eccentricity over radius", off=0.0)
    phase = Parameter("rad", 0.0, (-3.15, 3.15), text="angle of the eccentricity", shape=True)
    zeroed = Parameter("1", 1.0, (0.0, 1.0), text="share of the error at the arm's zero that was set to zero there")


class EncoderLag(Instance):
    r"""The arm encoder reports the angle late.

    .. math:: \theta_m = \frac{1 - \beta\,T s}{1 + (1 - \beta)\,T s}\;\theta_a

    late by T at every steady speed; a first-order lag at beta = 0, a dead time (its Pade approximant) at beta = 1/2.
    Seen as: an angle error in proportion to speed, with the sign of the motion.
    Not for: a late pump (its delay is part of the transfer function).
    Source: first-order sensor lag, e.g. Doebelin (2004), Measurement Systems, 5th ed., section 3.3; Pade approximants of
    a dead time, e.g. Franklin, Powell & Emami-Naeini (2010), Feedback Control of Dynamic Systems, section 5.6.3.
    """

    of = "sensor_lag"
    at = {"encoder": {"caught": "lagged_angle"}}  # noqa: RUF012
    lag = Parameter("s", 5e-3, (1e-4, 0.2), "log-uniform", "time by which the angle is late", off=0.0)
    dead_share = Parameter("1", 0.25, (0.0, 0.5), text="0: a first-order lag, 0.5: a dead time")
    lagged_angle = State("rad", 1e-6, 0.1, text="angle that the encoder has caught up with")


class EntrainedAir(Instance):
    r"""Bubbles in a line make it softer at low pressure.

    .. math:: \frac{1}{K} = \frac{1}{K_0} + \frac{V_a p_{atm}}{(p + p_{atm})^2}

    with V_a the air of one line at atmospheric pressure, compressed isothermally.
    Seen as: dp/dV that falls with pressure; a preload far from the usual one shows it.
    Not for: delayed extra volume (see tubing_creep).
    Source: thesis 4.4.3.4 - 4.4.3.6, 4.4.3.14.
    """

    of = "entrained_air"
    at = {"line1": {}, "line2": {}}  # noqa: RUF012
    air_volume = Parameter("m^3", 8.5e-9, (0.0, 3e-7), text="air of one line at atmospheric pressure (0.5 %: 8.5 mm3)", off=0.0)


class FrictionDrift(Instance):
    r"""Static and Coulomb friction of the seals change during a test, by warming or wear, at a rate that fades.

    .. math:: F \leftarrow F\,\bigl(1 + d\,\tau\,(1 - e^{-q/\tau})\bigr), \quad q = t + s / v_0

    with t = 0 at the start of the command, where the base friction applies, and s the travel since then; the next test
    starts again. A pace v_0 far above the speeds of the test: it goes with time; far below: with the travel alone. A long
    settling time: a steady drift. Viscous friction stays.
    Seen as: the same motion needs another force late in a test than early in it.
    Not for: change from test to test (scatter), or with rest (see static_friction_ageing).
    Source: a body that warms by its own friction, first order (Incropera & DeWitt (2002), section 5.1);
    Armstrong-Helouvry (1991), Control of Machines with Friction, chapter 4.
    """

    of = "friction_drift"
    at = {"seal": {}}  # noqa: RUF012
    without = ("viscous",)
    drift = Parameter("1/s", 0.05, (-1.0, 2.0), text="share of friction gained in each second at first", off=0.0)
    settling_time = Parameter(
        "s", 10.0, (0.2, 100.0), "log-uniform", "time after which the rate has fallen to 37 %", shape=True
    )
    pace = Parameter("m/s", 1.0, (1e-3, 1.0), "log-uniform", "speed at which travel counts as much as time", shape=True)
    travelled = State("m", 1e-6, 0.01, text="travel since the start of the command")
    last_position = State("m", 1e-6, 0.01, text="travel of the sliders one sample ago")


class Leakage(Instance):
    r"""Water is lost from each line, in proportion to its pressure and faster above a threshold.

    .. math:: q_{leak} = G\,p + G_t \max(p - p_t, 0)

    Seen as: both pressures fall with time, most at rest under high pressure.
    Not for: water that comes back (see tubing_creep) or that goes to the other line (see cross_leakage).
    Source: thesis 4.4.4 (0.03 MPa/s at 0.62 MPag, below 0.5 %/s under 0.58 MPag).
    """

    of = "leakage"
    at = {"line1": {}, "line2": {}}  # noqa: RUF012
    conductance = Parameter("m^3/(s*Pa)", 2e-16, (0.0, 1e-11), text="flow for each pascal of line pressure", off=0.0)
    threshold = Parameter("Pa", 0.59e6, (0.0, 2e6), text="pressure above which the fittings open", shape=True)
    conductance_above = Parameter("m^3/(s*Pa)", 3.9e-14, (0.0, 1e-11), text="further flow per pascal above it", off=0.0)


class PositionFriction(Instance):
    r"""Static and Coulomb friction rise and fall along the travel: a bent rod, a groove, an uneven seal, a burr.

    .. math:: F \leftarrow F\,(1 + a\,w), \quad w = \frac{e^{k s} - 1}{\mathrm{sgn}(k)\,(e^{|k|} - 1)}, \quad
              s = \sin(2\pi\,\theta / \Theta + \varphi)

    a sine where the concentration k is 0; above, a bump of width Theta / (2 pi sqrt(k)), the curve of von Mises; below, a dip.
    What depends on the angle comes again after a turn: periods are a turn or less.
    Seen as: a force that depends on arm angle and turns its sign with the direction of motion.
    Not for: a force with one sign in both directions (see gravity_load), or change with time (see friction_drift).
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138,
    doi:10.1016/0005-1098(94)90209-7; thesis 3.6 (rack and pinion: position-dependent friction); the curve: Mardia & Jupp
    (2000), Directional Statistics, section 3.5.4.
    """

    of = "position_friction"
    at = {"seal": {"travel": "slider_angle"}}  # noqa: RUF012
    without = ("viscous",)
    amplitude = Parameter("1", 0.2, (0.0, 0.9), text="largest change of friction over its mean", off=0.0)
    period = Parameter(
        "rad", 6.283185307179586, (0.3, 6.3), "log-uniform", "arm angle of one period, a turn or less", shape=True
    )
    phase = Parameter("rad", 0.0, (-3.15, 3.15), text="phase at arm angle 0", shape=True)


class Presliding(Instance):
    r"""Before breakaway the seals give way like springs; friction falls once the whole contact slips.

    .. math:: \dot q_i = v\,(1 - r_i^2)\ \text{where}\ r_i v > 0,\ \text{else}\ v, \quad r_i = \frac{q_i}{c_i\,g}, \quad
              g = F_s - (F_s - F_c)\,w, \quad c_i = c\,(0.2,\ 1,\ 1.8)

    .. math:: f = h + d\,\dot q + C_v v, \quad h = \sum_i \frac{q_i}{3 c_i}, \quad
              \tau \dot w = \frac{s^2}{s^2 + v_s^2} - w, \quad s = |v|\,\min\Bigl(\frac{|h|}{g}, 1\Bigr)^n

    with three bristles that carry a third of the friction each and yield one after the other, over a decade of travel; slip
    s, weakness w, damping d = 2 (1 - w) sqrt(m / c) of their mean bending, and as memory tau the period of the slider on them.
    Breaks away at F_s, slides at F_c + C_v v. At rest the bristles carry the push: from there a test starts.
    Seen as: motion of some hundredths of a millimetre below breakaway, and its recovery when the force is taken off.
    Not for: the fall of friction at speeds far above v_s (see stribeck_friction).
    Source: elements that yield one by one: Iwan (1966), doi:10.1115/1.3625199; their friction: Al-Bender et al. (2005),
    doi:10.1109/TAC.2005.858676; no slip while unloading: Dupont et al. (2002), doi:10.1109/TAC.2002.1000274; memory: Hess
    & Soom (1990), doi:10.1115/1.2920239.
    """

    of = "presliding"
    at = {"seal": {}}  # noqa: RUF012
    compliance = Parameter("m/N", 1e-5, (2e-6, 2e-4), "log-uniform", "mean deflection for each newton", shape=True, off=0.0)
    fall_velocity = Parameter(
        "m/s",
        5e-4,
        (5e-5, 2e-2),
        "log-uniform",
        "slip at which half of the extra static friction is gone",
        shape=True,
        off=0.0,
    )
    lateness = Parameter("1", 16.0, (0.0, 40.0), text="0: friction falls with any motion; large: with full slip only")
    deflection = State("m", 2e-8, 1e-5, text="deflection of the middle bristles", known=True)
    stiff_deflection = State("m", 2e-8, 1e-5, text="deflection of the stiff bristles", known=True)
    soft_deflection = State("m", 2e-8, 1e-5, text="deflection of the soft bristles", known=True)
    weakness = State("1", 1e-2, 1.0, text="share of the extra static friction that slip has taken", known=True)


class StaticFrictionAgeing(Instance):
    r"""While the slider rests, its seals squeeze the water out and stick better.

    .. math:: F_s \leftarrow F_s\,\Bigl(1 + a\,\frac{t_r}{t_r + \gamma}\Bigr)

    with t_r the time at rest. ``rest_before`` is the rest before the log began, the same in all tests.
    Seen as: a higher breakaway after a longer rest; the first breakaway of a test stands out.
    Not for: friction that changes while sliding (see friction_drift). Static friction is that of a fresh stop here.
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138,
    doi:10.1016/0005-1098(94)90209-7 (rising static friction of the seven-parameter model).
    """

    of = "static_friction_ageing"
    at = {"seal": {}}  # noqa: RUF012
    growth = Parameter("1", 0.4, (0.0, 4.0), text="growth of static friction after a long rest", off=0.0)
    half_time = Parameter("s", 0.3, (5e-3, 30.0), "log-uniform", "rest after which half of it has come", shape=True)
    rest_before = Parameter("s", 2.0, (1e-2, 1e3), "log-uniform", "rest before the log began", shape=True)
    rest_began = State("s", 1e-6, 1.0, text="time at which the slider came to rest")


class StribeckFriction(Instance):
    r"""Friction falls gradually from static to Coulomb as the seal starts to slide.

    .. math:: f_c \mathrel{+}= (F_s - F_c)\, e^{-(\dot y / v_s)^2}

    Seen as: a force that falls with speed after breakaway; slower slips, overshoot after each stick.
    Not for: behaviour before breakaway (see presliding).
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138.
    """

    of = "stribeck_friction"
    at = {"seal": {}}  # noqa: RUF012
    stribeck_velocity = Parameter(
        "m/s",
        6e-3,
        (5e-4, 5e-2),
        "log-uniform",
        "speed at which the extra friction has fallen to 37 %",
        shape=True,
        off=0.0,
    )


INSTANCES: tuple[type[Instance], ...] = (
    CrossLeakage,
    DitherRelief,
    EncoderBias,
    EncoderEccentricity,
    EncoderLag,
    EntrainedAir,
    FrictionDrift,
    Leakage,
    PositionFriction,
    Presliding,
    StaticFrictionAgeing,
    StribeckFriction,
)

# What else is generic, and why the joint has no need of it.
COVERS = {
    "added_mass": "payload_inertia, in the payload's own mass and radius",
    "moving_backlash": "pump_backlash, which knows which flank the pressures press on",
    "dead_band": "its own position loop moves the pump, and the pump's encoder shows what it does",
    "saturation": "pump_speed_limit and pump_acceleration_limit limit the pump",
    "command_delay": "pump_delay holds it",
    "action_lag": "its motor and its water are lags of their own",
    "constant_force": "static, Coulomb and viscous friction of each direction are base parameters of their own",
    "contact_creep": "its contacts stick: static friction is a base parameter of its own",
    "coulomb_asymmetry": "Coulomb and static friction of each direction are base parameters of their own",
    "dry_friction": "Coulomb and static friction of each direction are base parameters of their own",
    "viscous_friction": "viscous friction of each direction is a base parameter of its own",
    "viscous_asymmetry": "viscous friction of each direction is a base parameter of its own",
    "stribeck_excess": "static friction is a base parameter of its own; stribeck_friction falls from it",
    "quadratic_drag": "the flow in the lines is laminar (line_resistance), and the sliders are slow",
    "load_friction": "pressure_friction, with the sum of both pressures as the load",
    "spring": "the lines hold the sliders like a spring (line_stiffness)",
    "cubic_spring": "the lines hold the sliders like a spring (line_stiffness); entrained_air makes it progressive",
    "soft_stop": "travel_stop and stop_stiffness are parameters of the joint",
    "hard_stop": "travel_stop and stop_stiffness are parameters of the joint",
    "maxwell_element": "the lines hold the sliders like a spring (line_stiffness), and tubing_creep relaxes them",
    "second_store": "tubing_creep takes up water late and gives it back",
    "overflow": "a closed line has no brim",
    "spill_over": "a closed line has no brim",
    "check_valve": "no flow crosses between the lines but cross_leakage, a gap that has no direction",
    "flow_exponent": "no flow crosses between the lines but cross_leakage, which is laminar",
    "internal_leakage": "cross_leakage, from one line to the other",
    "transmission_compliance": "string_elasticity, in which the arm swings",
    "flow_resistance": "line_resistance, which knows on which side of it the line gives way",
    "flow_inertance": "line_inertance, which knows on which side of it the line gives way",
    "backlash": "pump_backlash, which knows which flank the pressures press on",
    "pendulum_weight": "gravity_load, in the payload's own mass and radius",
    "sensor_gain": "pressure_gain, of both sensors at once; the encoders count, and their scale is exact",
    "sensor_drift": "pressure_offset may drift; the encoders count from a zero that is set before each test",
}
