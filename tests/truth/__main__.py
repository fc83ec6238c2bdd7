"""Write a hidden case: `python -m tests.truth OUT --effect leakage --strength medium --seed 3`."""

import argparse
import sys
from pathlib import Path

import yaml

from truth.pump_joint.case import CONTACTS, write_case
from truth.pump_joint.hidden import LIBRARY_NAMES, OUTSIDE_NAMES, STRENGTHS
from truth.pump_joint.menu import MENUS, Condition, asked


def main(arguments: list[str] | None = None) -> int:
    """Write the case that the command line asks for; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.truth", description=__doc__)
    parser.add_argument("folder", type=Path, metavar="OUT", help="folder for the logs; the answer goes beside it")
    parser.add_argument(
        "--effect",
        action="append",
        default=[],
        choices=[*LIBRARY_NAMES, *OUTSIDE_NAMES],
        metavar="NAME",
        help="repeat it for two effects; none gives a null",
    )
    parser.add_argument("--strength", default="medium", help=f"{', '.join(STRENGTHS)}, or a number in SI")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--menu", choices=list(MENUS), default="standard")
    parser.add_argument("--repetitions", type=int)
    parser.add_argument("--contact", choices=CONTACTS, default="asperities", help="the law of dry friction")
    parser.add_argument("--form", help="the law of effects that have several: its name, or random")
    parser.add_argument("--payload", choices=["none", "brass_8p5g"], default="none")
    parser.add_argument("--orientation", choices=["horizontal", "vertical"], default="horizontal")
    parser.add_argument("--phases", choices=["command", "all"], default="command")
    parser.add_argument("--campaign", type=Path, help="a campaign file: run its tests on the rig of this seed")
    options = parser.parse_args(arguments)
    try:
        strength: str | float = options.strength if options.strength in STRENGTHS else float(options.strength)
    except ValueError:
        parser.error(f"--strength {options.strength!r}: give one of {', '.join(STRENGTHS)}, or a number in SI")
    answer = write_case(
        options.folder,
        options.effect,
        strength,
        options.seed,
        menu=options.menu,
        repetitions=options.repetitions,
        payload=options.payload,
        orientation=options.orientation,
        phases=options.phases,
        conditions=read_campaign(options.campaign) if options.campaign else (),
        contact=options.contact,
        form=options.form,
    )
    print(f"logs in {options.folder}, sealed answer in {answer}")
    return 0


def read_campaign(path: Path) -> list[Condition]:
    """Return the conditions of a campaign file with one axis of cases."""
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    (cases,) = content["vary"].values()
    return [asked(name, {**content["fixed"], **settings}) for name, settings in cases.items()]


if __name__ == "__main__":
    sys.exit(main())
