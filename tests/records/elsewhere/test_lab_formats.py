"""What labs record: one measurement in every kind of file gives equal logs, and no damage of any kind gives a traceback."""

from __future__ import annotations

import random
import shutil
import sqlite3
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xlsxwriter
import yaml
from foreign_truth import FIELDS, TIME, U, X, imported, is_truth, mapped
from mcap_ros2.writer import Writer as Ros2Writer
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.import_map import read_import_map
from hjcamp.records.elsewhere.readers import reader_of, readers

COLUMNS = {"t": TIME, "x": X, "u": U}
UNITS = {"t": "s", "x": "mm", "u": "V"}
KIND = "rig_msgs/msg/State"
DEFINITION = "float64 t\nfloat64[] x\nAxis axis\n" + "=" * 80 + "\nMSG: rig_msgs/Axis\nfloat64 u\nstring name\n"
STORE = get_typestore(Stores.ROS2_HUMBLE)
BEGAN = 1_700_000_000 * 10**9
MESSAGES = {"position_m": {"column": "x[0]", "unit": "mm"}, "voltage_v": "axis.u"}


def write_npz(path: Path) -> None:
    np.savez(path, m=np.stack([TIME, X], axis=1), log=np.array(list(zip(U, X, strict=True)), dtype=[("u", "f8"), ("x", "f8")]))


def write_workbook(path: Path, *more: str) -> None:
    with xlsxwriter.Workbook(str(path)) as book:
        for name in ("run", *more):
            sheet = book.add_worksheet(name)
            sheet.write_row(0, 0, ["Rig 3", "", "operator"])
            sheet.write_row(2, 0, list(COLUMNS))
            for place, values in enumerate(COLUMNS.values()):
                sheet.write_column(3, place, values)


def write_tdms(path: Path, *more: str, step: float | None = 0.01) -> None:
    with TdmsWriter(path) as writer:
        for group in ("run", *more):
            channels = [
                ChannelObject(group, name, values, {"unit_string": UNITS[name]} | ({"wf_increment": step} if step else {}))
                for name, values in COLUMNS.items()
                if name != "t" or not step
            ]
            writer.write_segment([RootObject(), GroupObject(group), *channels])


def write_hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        run = file.create_group("run")
        for name, values in COLUMNS.items():
            run.create_dataset(name, data=values, compression="gzip", chunks=(100,)).attrs["units"] = UNITS[name]


def write_mat_73(path: Path) -> None:
    """Write variables as MATLAB 7.3 does: a matrix transposed, a structure as a group, a cell as references."""
    with h5py.File(path, "w", userblock_size=512) as file:
        file.create_dataset("m", data=np.stack([TIME, X])).attrs["MATLAB_class"] = np.bytes_("double")
        file.create_group("d").attrs["MATLAB_class"] = np.bytes_("struct")
        kept = file.create_dataset("#refs#/a", data=U.reshape(1, -1))
        kept.attrs["MATLAB_class"] = np.bytes_("double")
        file["d"].create_dataset("u", data=np.array([[kept.ref]], dtype=h5py.ref_dtype)).attrs["MATLAB_class"] = np.bytes_(
            "cell"
        )
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


def write_ros2_mcap(path: Path) -> None:
    with path.open("wb") as stream:
        writer = Ros2Writer(stream)
        schema = writer.register_msgdef(KIND, DEFINITION)
        for t, x, u in zip(TIME, X, U, strict=True):
            stamp = BEGAN + round(t * 1e9)
            writer.write_message("/state", schema, {"t": t, "x": [x, 0.0], "axis": {"u": u, "name": "a"}}, stamp, stamp)
        writer.finish()


def write_db3(path: Path, definitions: bool = True, plugin: StoragePlugin = StoragePlugin.SQLITE3) -> None:
    """Write a recording of joints: position and effort."""
    kind = "sensor_msgs/msg/JointState"
    header, joint, stamp = (
        STORE.types[one] for one in ("std_msgs/msg/Header", "sensor_msgs/msg/JointState", "builtin_interfaces/msg/Time")
    )
    with BagWriter(path.parent / "bag", version=9, storage_plugin=plugin) as bag:
        place = bag.add_connection("/state", kind, typestore=STORE)
        for t, x, u in zip(TIME, X, U, strict=True):
            at = BEGAN + round(t * 1e9)
            head = header(stamp(at // 10**9, at % 10**9), "base")
            sample = joint(head, ["a"], np.array([x]), np.array([]), np.array([u]))
            bag.write(place, at + 5, STORE.serialize_cdr(sample, kind))
    shutil.move(path.parent / "bag" / "bag.db3", path)
    shutil.rmtree(path.parent / "bag")
    if not definitions:
        with sqlite3.connect(path) as database:
            database.execute("DROP TABLE message_definitions")
        database.close()


Made = tuple[Callable[[Path], None], dict[str, Any], dict[str, Any]]
JOINT = {"time_s": "header.stamp", "position_m": {"column": "position[0]", "unit": "mm"}, "voltage_v": "effort[0]"}
MADE: dict[str, Made] = {
    "a.npz": (write_npz, {"time_s": "m[:,0]", "position_m": {"column": "m[:,1]", "unit": "mm"}, "voltage_v": "log.u"}, {}),
    "a.xlsx": (write_workbook, {}, {}),
    "a.tdms": (write_tdms, {"time_s": None}, {}),
    "b.tdms": (lambda path: write_tdms(path, "other", step=None), {}, {"group": "run"}),
    "a.h5": (write_hdf5, {}, {"group": "run"}),
    "b.h5": (write_hdf5, {"time_s": "run/t", "position_m": {"column": "run/x", "unit": "mm"}, "voltage_v": "run/u"}, {}),
    "a.mat": (write_mat_73, {"time_s": "m(:,1)", "position_m": {"column": "m(:,2)", "unit": "mm"}, "voltage_v": "d.u"}, {}),
    "a.mcap": (write_ros2_mcap, {"time_s": None, **MESSAGES}, {"topic": "/state"}),
    "a.db3": (write_db3, JOINT, {"topic": "/state"}),
    "b.db3": (lambda path: write_db3(path, definitions=False), JOINT, {"topic": "/state"}),
}


def map_of(name: str, **more: Any) -> Path:
    _, fields, keys = MADE[name]
    path = Path("map.yaml")
    wanted = {field: rule for field, rule in (FIELDS | fields).items() if rule}
    path.write_text(yaml.safe_dump({"plant": "stage", "fields": wanted} | keys | more))
    return path


@pytest.mark.parametrize("name", MADE)
def test_one_measurement_in_every_kind_of_file_gives_equal_logs(folder: Path, name: str) -> None:
    MADE[name][0](Path(name))
    is_truth(imported(Path(name), map_of(name))[1], near=1e-9)


@pytest.mark.parametrize("name", MADE)
def test_a_file_says_what_columns_and_units_it_has(folder: Path, name: str) -> None:
    MADE[name][0](Path(name))
    rules = read_import_map(map_of(name))
    found = {one.name: one.unit for one in reader_of(Path(name)).columns(Path(name), rules)}
    asked = [rule.column for rule in rules.rules.values()]
    assert set(asked) <= set(found) and len(found) == len(set(found)) <= 8
    if name.endswith((".tdms", ".h5")):
        assert found[asked[-2]] == "mm" and found[asked[-1]] == "V"


REFUSED: dict[str, tuple[Callable[[Path], None], dict[str, Any], str]] = {
    "two sheets": (
        lambda path: write_workbook(path, "other"),
        {},
        "has 2 sheets; say in the map sheet: NAME, one of run, other",
    ),
    "no such sheet": (write_workbook, {"sheet": "rum"}, "unknown sheet 'rum'.*did you mean 'run'"),
    "two groups": (lambda path: write_tdms(path, "other"), {}, "has 2 groups; say in the map group: NAME, one of run, other"),
    "no such group": (write_tdms, {"group": "rum"}, "unknown group 'rum'.*did you mean 'run'"),
    "no such group in HDF5": (write_hdf5, {"group": "rum"}, "unknown group 'rum'.*did you mean 'run'"),
    "no such data set": (write_hdf5, {}, "unknown array 't'.*run/t"),
    "no such topic": (write_db3, {"topic": "/stat"}, "unknown topic '/stat'.*did you mean '/state'"),
    "no topic": (write_ros2_mcap, {}, "give the topic of .*/state"),
}
ENDS = {write_hdf5: ".h5", write_db3: ".db3", write_ros2_mcap: ".mcap", write_tdms: ".tdms", write_workbook: ".xlsx"}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_open_or_wrong_is_refused_with_what_helps(folder: Path, case: str) -> None:
    write, keys, said = REFUSED[case]
    ending = ENDS.get(write, ".xlsx" if "sheet" in case else ".tdms")
    write(Path(f"a{ending}"))
    with pytest.raises(UsageError, match=said) as refusal:
        imported(Path(f"a{ending}"), mapped(**keys))
    assert "\n" not in str(refusal.value)


def test_waveforms_of_two_clocks_are_refused(folder: Path) -> None:
    with TdmsWriter("a.tdms") as writer:
        channels = [
            ChannelObject("run", name, COLUMNS[name], {"wf_increment": step}) for name, step in (("x", 0.01), ("u", 0.02))
        ]
        writer.write_segment(channels)
    with pytest.raises(UsageError, match=r"clocks of their own .*x 0.01 s, u 0.02 s"):
        imported(Path("a.tdms"), map_of("a.tdms"))


@pytest.mark.parametrize("name", [one for one in MADE if one.startswith("a")])
def test_a_damaged_file_is_read_or_refused_in_one_line(folder: Path, name: str) -> None:
    source, damaged = Path(f"whole{Path(name).suffix}"), Path(name)
    MADE[name][0](source)
    content, chance, mapping = source.read_bytes(), random.Random(name), map_of(name)
    refused = 0
    for number in range(40):
        spoilt = bytearray(content[: int(chance.random() * len(content))] if number % 2 else content)
        for _ in range(0 if number % 4 == 1 else chance.choice([1, 4, 64])):
            if spoilt:
                spoilt[chance.randrange(len(spoilt) if number % 3 else min(2048, len(spoilt)))] = chance.randrange(256)
        damaged.write_bytes(spoilt)
        try:
            imported(damaged, mapping)
        except UsageError as refusal:
            refused += 1
            assert "\n" not in str(refusal) and len(str(refusal)) < 1500
        Path("out.mcap").unlink(missing_ok=True)
    assert refused


def test_a_file_that_would_unpack_to_more_than_a_test_is_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hjcamp.records.elsewhere.reader.MOST_BYTES", 1000)
    for name in ("a.npz", "a.xlsx", "a.tdms", "a.h5", "a.mat"):
        MADE[name][0](Path(name))
        with pytest.raises(UsageError, match="GiB can be read"):
            imported(Path(name), map_of(name))


@pytest.mark.parametrize("name", sorted(one.name for one in readers().values() if one.packages))
def test_a_missing_extra_is_named_with_its_command(folder: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    reader = readers()[name]
    monkeypatch.setattr("hjcamp.records.elsewhere.reader.find_spec", lambda package: None)
    source = Path(f"a{reader.endings[0]}")
    source.write_bytes(b"any")
    with pytest.raises(
        UsageError, match=rf"needs the extra '{reader.extra}', which is not installed: pip install 'hjcamp\[{reader.extra}\]'"
    ):
        imported(source, mapped())


def test_numbers_of_a_workbook_keep_their_digits_also_among_texts(folder: Path) -> None:
    values = np.random.default_rng(1).normal(size=60)
    with xlsxwriter.Workbook("a.xlsx") as book:
        sheet = book.add_worksheet("run")
        sheet.write_column(0, 0, ["t", "s", *0.01 * np.arange(60)])
        sheet.write_column(0, 1, ["x", "mm", *values[:20], "---", *values[21:]])
        sheet.write_column(0, 2, ["u", "V", *values])
    _, columns = imported(Path("a.xlsx"), mapped(units_below=True, gaps="interpolate", missing="---"))
    values_x = np.append(np.delete(1e3 * columns["position_m"], 20), 0.0)
    np.testing.assert_allclose(values_x[:-1], np.delete(values, 20), rtol=2e-15)
    np.testing.assert_allclose(columns["voltage_v"], values, rtol=2e-15)
