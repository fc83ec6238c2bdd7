"""A configuration file holds values: none may run code, whichever way it comes into a call."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from omegaconf import OmegaConf

import hjcamp
from hjcamp import cli
from hjcamp.campaign.plan.campaign_file import read_campaign
from hjcamp.configuration.composer import Composer
from hjcamp.configuration.search_path import packaged_root
from hjcamp.configuration.trust import check_file
from hjcamp.errors import UsageError

# Hydra itself does not block this one.
CALL = "{_target_: pathlib.Path.write_text, _args_: [{_target_: pathlib.Path, _args_: [marker]}, x]}"
MODEL = "name: friend\nparameters: {}\neffects: {}\n"
FILES = {
    "callbacks from a model": ("model/friend.yaml", f"# @package _global_\nhydra:\n  callbacks: {{x: {CALL}}}\n", "line 3"),
    "a call in a model": ("model/friend.yaml", MODEL + f"provenance: {{x: [{CALL}]}}\n", "line 4: '_target_' names code"),
    "hydra in a model": ("model/friend.yaml", "# @package _global_\nhydra:\n  job: {chdir: true}\n", "line 2: 'hydra' belongs"),
    "a package in hydra": ("model/friend.yaml", "# @package hydra.callbacks\nx: {a: 1}\n", "@package hydra.callbacks"),
    "defaults into hydra": ("model/friend.yaml", "defaults:\n  - /payload@hydra.callbacks.x: none\n", "reaches into 'hydra'"),
    "defaults override hydra": (
        "model/friend.yaml",
        "defaults:\n  - override /hydra/launcher: joblib\n",
        "reaches into 'hydra'",
    ),
    "not UTF-8": ("model/friend.yaml", b"name: friend\nunit: \xb0C\n", "line 2: this is not UTF-8 text"),
    "the main configuration": ("config.yaml", f"hydra: {{callbacks: {{x: {CALL}}}}}\n", "line 1: 'hydra' belongs"),
    "defaults of the main one": ("config.yaml", "defaults:\n  - override hydra/launcher: mine\n", "reaches into 'hydra'"),
    "a callback group": ("hydra/launcher/basic.yaml", f"x: {CALL}\n", "hydra/launcher/basic.yaml: configuration of 'hydra'"),
    "a sweeper group": ("hydra/sweeper/basic.yaml", "max_batch_size: 1\n", "hydra/sweeper/basic.yaml: configuration of"),
}
ALWAYS_READ = ("config.yaml", "hydra/")


@pytest.fixture
def call(empty_folder: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str]]:
    """Return the function that calls ``hjcamp ARGUMENTS`` and returns the code and what was said."""

    def answer(*arguments: str) -> tuple[int, str]:
        code = cli.run(list(arguments))
        said = capsys.readouterr()
        return code, said.out + said.err

    return answer


def write(path: Path, content: str | bytes) -> None:
    """Write a file of the user's."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content.encode() if isinstance(content, str) else content)


@pytest.mark.parametrize("command", [["run"], ["plan"], ["run", "-m"], ["run", "--cfg", "job"]], ids=" ".join)
@pytest.mark.parametrize("what", FILES)
def test_no_file_reaches_what_hydra_runs(
    what: str, command: list[str], empty_folder: Path, call: Callable[..., tuple[int, str]]
) -> None:
    name, content, told = FILES[what]
    write(empty_folder / "conf" / name, content)
    choice = [] if name.startswith(ALWAYS_READ) else ["model=friend"]
    code, said = call(*command, "repetitions=1", *choice)
    assert code == 2 and told in said and name in said, said
    assert len(said.strip().splitlines()) == 1, said
    assert not (empty_folder / "marker").exists() and not (empty_folder / "runs").exists()


@pytest.mark.parametrize("way", ["--config-dir", "hydra.searchpath", "HJCAMP_CONF"])
def test_whichever_way_the_folder_comes(
    way: str, empty_folder: Path, call: Callable[..., tuple[int, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    write(empty_folder / "more" / "model" / "friend.yaml", MODEL + f"x: {CALL}\n")
    given = {"--config-dir": ["--config-dir", "more"], "hydra.searchpath": [f"hydra.searchpath=[{empty_folder}/more]"]}
    monkeypatch.setenv("HJCAMP_CONF", "more" if way == "HJCAMP_CONF" else "")
    for command in ("run", "plan"):
        code, said = call(command, "model=friend", "repetitions=1", *given.get(way, []))
        assert code == 2 and "'_target_' names code" in said and "friend.yaml: line 4" in said, said
    assert not (empty_folder / "marker").exists()


def test_a_model_that_compare_is_given(empty_folder: Path) -> None:
    write(empty_folder / "conf" / "model" / "friend.yaml", f"# @package _global_\nhydra: {{callbacks: {{x: {CALL}}}}}\n")
    with pytest.raises(UsageError, match=r"friend\.yaml: line 2"):
        Composer().model("friend")


def test_a_campaign_names_no_code(empty_folder: Path, call: Callable[..., tuple[int, str]]) -> None:
    write(empty_folder / "campaigns" / "mine.yaml", f"name: mine\nvary: {{payload: [none]}}\nfixed: {{x: {CALL}}}\n")
    code, said = call("plan", "campaign=mine")
    assert code == 2 and "mine.yaml: line 3: '_target_' names code" in said


@pytest.mark.parametrize("key", ["hydra/launcher", "hydra.launcher.n_jobs", "hydra", "workers", "hydra/sweeper@x"])
def test_a_campaign_does_not_vary_how_it_is_run(key: str) -> None:
    for content in ({"vary": {key: ["joblib"]}}, {"vary": {"case": {"a": {key: 1}}}}):
        with pytest.raises(UsageError, match="belongs to the run, not to a condition"):
            read_campaign({"name": "mine", **content}, "mine")


@pytest.mark.parametrize(
    "line",
    [
        "+x._target_=os.system",
        "+x={a:[{_target_:os.system}]}",
        "+x={'_target_':os.system}",
        "hydra.launcher._target_=os.system",
        "+hydra.callbacks.x={a:1}",
        "hydra/job_logging=default",
        "hydra.job_logging.version=1",
        "+model@hydra.callbacks=published",
        "~hydra.callbacks.sweep",
        "hydra.searchpath=[pkg://antigravity]",
    ],
)
def test_overrides_that_are_refused(line: str, call: Callable[..., tuple[int, str]]) -> None:
    for command in (["run"], ["plan"], ["run", "-m"]):
        code, said = call(*command, "repetitions=1", line)
        assert code == 2 and line in said and len(said.strip().splitlines()) == 1, said


@pytest.mark.parametrize("flag", ["--config-name=x", "--config-path=x", "--experimental-rerun=x.pickle"])
def test_flags_that_are_refused(flag: str, call: Callable[..., tuple[int, str]]) -> None:
    code, said = call("run", flag)
    assert code == 2 and flag.split("=")[0] in said, said


@pytest.mark.study
def test_every_file_of_ours_would_pass_as_a_users(empty_folder: Path) -> None:
    """So does whoever begins with a copy of one, or of all."""
    choices: tuple[list[str], ...] = ([], ["payload=brass_8p5g", "orientation=vertical", "controller=ffwd_pid"])
    expected = [Composer().compose(lines).config for lines in choices]
    for path in sorted((packaged_root() / "conf").rglob("*.yaml")):
        write(empty_folder / "conf" / path.relative_to(packaged_root() / "conf"), path.read_bytes())
    composer = Composer()
    assert f"file://{empty_folder / 'conf'}" in composer.places()
    assert [composer.compose(lines).config for lines in choices] == expected


def test_an_own_main_configuration_runs_with_our_hydra(empty_folder: Path, call: Callable[..., tuple[int, str]]) -> None:
    text = (packaged_root() / "conf" / "config.yaml").read_text()
    without = text[: text.index("\nhydra:")].replace("  - override hydra/job_logging: disabled\n", "")
    assert "pump: pump2" in without and "hydra" not in without
    write(empty_folder / "conf" / "config.yaml", without.replace("seed,1}", "seed,4}"))
    code, said = call("plan", "--json", "-")
    assert code == 0 and '"seed": 4' in said, said
    assert call("run", "--cfg", "job")[0] == 0
    assert sorted(path.name for path in empty_folder.iterdir()) == ["conf"], "Hydra made its own folders"
    assert "SweepFolder" in call("run", "--cfg", "hydra")[1]


def test_a_sweep_over_a_users_models_on_workers(empty_folder: Path) -> None:
    """The workers of Hydra's joblib launcher read the files anew: a good one is used there, a bad one is refused."""
    write(empty_folder / "conf" / "payload" / "mine.yaml", "name: mine\nmass_g: 2.0\n")
    write(empty_folder / "conf" / "payload" / "bad.yaml", f"name: bad\nmass_g: 2.0\nx: {CALL}\n")
    environment = {**os.environ, "PYTHONPATH": str(Path(hjcamp.__file__).parents[1]), "NUMBA_DISABLE_JIT": "1"}
    command = [
        sys.executable,
        "-m",
        "hjcamp",
        "run",
        "-m",
        "hydra/launcher=joblib",
        "repetitions=1",
        "payload=none,bad",
    ]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
    assert done.returncode == 2 and "bad.yaml: line 3" in done.stderr, done.stderr
    assert not (empty_folder / "marker").exists()


SECRET = "hunter2hunter2"
ASKS = (
    "${oc.env:SECRET_TOKEN}", "x ${oc.env:SECRET_TOKEN} y", "${ oc.env : SECRET_TOKEN}", "${first:null,${oc.env:SECRET_TOKEN}}",
    "${oc.decode:${oc.env:SECRET_TOKEN}}", "${oc.create:${oc.env:SECRET_TOKEN}}", "${oc.${name}:SECRET_TOKEN}",
    "${${name}:SECRET_TOKEN}", "${oc.env:SECRET_TOKEN,none}", "${hydra:runtime.cwd}", "${oc.deprecated:name}", "${now:%Y}",
)  # fmt: skip
PLACES = {
    "campaigns/friend.yaml": "name: friend\ndescription: {asks}\nvary: {{controller: [pid]}}\n",
    "conf/payload/friend.yaml": "name: {asks}\nmass_g: 1.0\n",
    "conf/rig/friend.yaml": "defaults: [virtual]\nname: friend\ncalibration: {asks}\n",
    "conf/model/friend.yaml": MODEL.replace("{}", "{{}}") + "provenance: {{made: [{asks}]}}\n",
    "conf/controller/friend.yaml": "defaults: [pid]\nnote: {{deep: [{{in: {asks}}}]}}\n",
    "conf/config.yaml": "name: {asks}\n",
}


@pytest.mark.parametrize("asks", ASKS)
def test_no_reference_leads_out_of_the_configuration(asks: str, tmp_path: Path) -> None:
    file = tmp_path / "friend.yaml"
    for content in ({"a": asks}, {"a": {"b": [1, {"c": f"x {asks}"}]}}, {"defaults": [{"payload": asks}]}):
        file.write_text(OmegaConf.to_yaml(OmegaConf.create(content)))
        with pytest.raises(UsageError, match=r"friend.yaml.*a reference is \$\{KEY\}"):
            check_file(file, OmegaConf.load(file), None)


@pytest.mark.parametrize("place", PLACES)
def test_no_file_takes_what_is_secret(
    place: str, empty_folder: Path, call: Callable[..., tuple[int, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SECRET_TOKEN", SECRET)
    write(empty_folder / place, PLACES[place].format(asks=f"'{ASKS[0]}'"))
    *_, group, _ = ("campaign", *place.split("/"))
    choice = {"config.yaml": []}.get(place.split("/")[-1], [f"{group.removesuffix('s')}=friend"])
    code, said = call("run", "repetitions=1", *choice)
    assert code == 2 and place in said and "reference is ${KEY}" in said, said
    assert SECRET not in said and len(said.strip().splitlines()) == 1
    assert not (empty_folder / "runs").exists()


def test_a_reference_to_a_key_and_one_on_the_command_line_are_read(
    empty_folder: Path, call: Callable[..., tuple[int, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SECRET_TOKEN", "7.5")
    write(
        empty_folder / "conf/payload/friend.yaml",
        "name: friend\nmass_g: ${oc.select:pump.nothing,8.5}\nradius_mm: ${.mass_g}\n",
    )
    config = Composer().compose(["payload=friend", "pump.bore_mm=${oc.env:SECRET_TOKEN}"]).config
    assert config["payload"]["mass_g"] == config["payload"]["radius_mm"] == 8.5
    assert float(config["pump"]["bore_mm"]) == 7.5


def test_two_campaigns_are_not_one(call: Callable[..., tuple[int, str]]) -> None:
    for command in ("plan", "run"):
        code, said = call(command, "campaign=controllers", "campaign=leakage")
        assert code == 2 and "a run is of one campaign" in said and len(said.splitlines()) == 1
