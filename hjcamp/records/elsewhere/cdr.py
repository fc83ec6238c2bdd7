"""Messages of ROS 2 in cdr, by the definition that comes with the recording."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.reader import first_line, need

EXTRA, PACKAGES = "ros2", ("mcap_ros2", "rosbags")
LONGEST_DEFINITION = 2**20


def parser_of(kind: str, definition: str, topic: str, where: str) -> Callable[[bytes, int], Any]:
    """Return what makes a message of its bytes, by a definition in the text of ROS 2; raises UsageError for another one."""
    need(EXTRA, PACKAGES, f"{where}: messages of ROS 2")
    from mcap_ros2._dynamic import generate_dynamic

    if len(definition) > LONGEST_DEFINITION:
        raise UsageError(f"{where}: the definition of {kind} on {topic} has {len(definition)} characters")
    try:
        decode = generate_dynamic(kind, definition)[kind]
    except Exception as error:  # the library raises many kinds for a text that is no definition
        raise UsageError(f"{where}: the definition of {kind} on {topic} cannot be read: {first_line(error)}") from error

    def parsed(data: bytes, index: int) -> Any:
        try:
            return decode(data)
        except Exception as error:  # as above, for bytes that are no such message
            raise UsageError(f"{where}: message {index} on {topic} is no {kind}: {first_line(error)}") from error

    return parsed


def known_definition(kind: str, topic: str, where: str) -> str:
    """Return the definition of a message that ROS 2 itself has, for recordings that carry none; raises UsageError for others."""
    need(EXTRA, PACKAGES, f"{where}: messages of ROS 2")
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    if kind not in store.types:
        raise UsageError(
            f"{where}: it holds no definition of {kind} on {topic}, which is none of ROS 2's own; write it again with them: "
            "ros2 bag convert"
        )
    return str(store.generate_msgdef(kind, ros_version=2)[0])
