"""A configuration that no test can be made with is refused with one message, before anything is run."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError

EFFECT = '''\
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class Mine(Effect):
    """A leak of my own."""

    subsystem = "lines"
    amount = Parameter("{unit}", 1e-9, (0.0, 1.0), text="flow")

    @staticmethod
    def {slot}(amount):
        """Return the flow."""
        return amount
'''


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("++effects.leekage.conductance=1", "unknown effect 'leekage' .* did you mean 'leakage'"),
        ("++effects.leakage.conductence=1", "did you mean 'conductance'"),
        ("++effects.leakage.conductance=-1", "effects.leakage.conductance is -1; a number from 0"),
        ("++effects.leakage=3", "effects.leakage is 3"),
        ("++effects.leakage=null", "effects.leakage is null; write {} for its defaults, or leave leakage out"),
        ("++model.effects.leakage=null", "model.effects.leakage is null"),
        ("++model.parameters.masss=1", "did you mean 'moving_mass'"),
        ("++model.effects.nothing.x=1", "unknown effect 'nothing'"),
        ("controller.name=pud", "unknown controller 'pud'; did you mean 'pid'"),
        ("+controller.positive.kk=1", "unknown parameter 'kk' in controller.positive"),
        ("+controller.foo=1", "unknown parameter 'foo' in controller"),
        ("controller.dither.waveform=sine", "waveform is 'sine'; 'square' is needed"),
        ("controller.dither.frequency_hz=0", "dither.frequency_hz is 0"),
        ("controller.dither.frequency_hz=600", "to 500"),
        ("controller.scale=-1", "controller.scale is -1"),
        ("controller.derivative_samples=120", "from 1 to 99"),
        ("backend=replay", "hjcamp compare"),
        ("backend.name=none", "backend.name is 'none'"),
    ],
)
def test_refused(composer: Composer, empty_folder: Path, override: str, words: str) -> None:
    config = composer.compose([override]).config
    with pytest.raises(UsageError, match=words):
        check_configuration(config)


@pytest.mark.parametrize("controller", ["open_loop", "pid", "ffwd_pid"])
def test_every_choice_of_ours_is_accepted(composer: Composer, empty_folder: Path, controller: str) -> None:
    for extra in ([], ["payload=brass_8p5g", "orientation=vertical"], ["controller.dither=null"]):
        check_configuration(composer.compose([f"controller={controller}", *extra]).config)


def test_a_model_of_the_controller_with_an_unknown_effect_is_refused(composer: Composer, empty_folder: Path) -> None:
    config = composer.compose(["controller=ffwd_pid"]).config
    config["controller_model"] = {"name": "other", "parameters": {}, "effects": {"leekage": {}}}
    with pytest.raises(UsageError, match="leakage"):
        check_configuration(config)


@pytest.mark.parametrize(
    ("unit", "slot", "words"),
    [("m^3/s", "leak1", None), ("m^3/s", "laek1", "did you mean 'leak1'"), ("Pa", "leak1", "m\\^3/s|unit")],
)
def test_an_effect_of_the_user(composer: Composer, empty_folder: Path, unit: str, slot: str, words: str | None) -> None:
    (empty_folder / "effects").mkdir()
    (empty_folder / "effects" / "mine.py").write_text(EFFECT.replace("{unit}", unit).replace("{slot}", slot))
    config = composer.compose(["++effects.mine.amount=1e-9"]).config
    if words is None:
        check_configuration(config)
    else:
        with pytest.raises(UsageError, match=words):
            check_configuration(config)


def test_an_effect_file_with_a_syntax_error_is_refused(composer: Composer, empty_folder: Path) -> None:
    (empty_folder / "effects").mkdir()
    (empty_folder / "effects" / "mine.py").write_text("class Mine(Effect:\n")
    with pytest.raises(UsageError, match=r"mine\.py: line 1"):
        check_configuration(composer.compose([]).config)
