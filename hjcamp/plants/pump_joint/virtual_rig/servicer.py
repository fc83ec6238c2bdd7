"""The vendor's gRPC service (the calls that a control loop needs) in front of the virtual device."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import grpc
from nidaqmx._stubs import nidaqmx_pb2 as messages
from nidaqmx._stubs.nidaqmx_pb2_grpc import NiDAQmxServicer
from nidaqmx.utils import unflatten_channel_string
from session_pb2 import Session

from hjcamp.plants.pump_joint.virtual_rig.device import PERIOD_S, VirtualDevice, Watchdog
from hjcamp.plants.pump_joint.virtual_rig.sessions import NO_SUCH_CHANNEL, NO_SUCH_TASK, RESERVED, DeviceError, Task

TASK_NAME = 0x1276
SAMPLES_ACQUIRED = 0x192A
PRODUCT, SERIAL = 0x631, 0x632
DEVICE_NAMES = 0x193B
DRIVER_VERSION = {0x1272: 26, 0x1923: 0, 0x2F22: 0}
PRODUCT_NAME, SERIAL_NUMBER = "Virtual-6363", 0x56525447
ANGLE_IN_TICKS = 10304
VOLTAGE, NO_CHANGE = 10322, 10160


def call(method: Callable[..., Any]) -> Callable[..., Any]:
    """Run one call alone, and turn an error of the device into what the vendor's client expects."""

    @functools.wraps(method)
    def answer(self: VirtualServicer, request: Any, context: Any) -> Any:
        with self.device.lock:
            if not context.is_active():
                # Its client has given it up: what it asked for may be the opposite of what is right by now.
                return context.abort(grpc.StatusCode.CANCELLED, "the call was given up")
            if self.device.tasks.holds(getattr(getattr(request, "task", None), "name", "")):
                self.device.called()
            self.device.catch_up()
            try:
                return method(self, request, context)
            except DeviceError as error:
                context.set_trailing_metadata((("ni-error", str(error.code)),))
                return context.abort(grpc.StatusCode.UNKNOWN, str(error))

    return answer


class VirtualServicer(NiDAQmxServicer):
    """Serves analog input, counter input, analog output, timing, watchdog and the questions a client asks."""

    def __init__(self, device: VirtualDevice) -> None:
        self.device = device
        self._watchdogs: set[str] = set()

    @call
    def GetSystemInfoAttributeUInt32(self, request: Any, context: Any) -> Any:  # noqa: N802 - the vendor's names
        return messages.GetSystemInfoAttributeUInt32Response(value=DRIVER_VERSION.get(request.attribute_raw, 0))

    @call
    def GetSystemInfoAttributeString(self, request: Any, context: Any) -> Any:  # noqa: N802
        wiring = self.device.wiring
        names = ", ".join(wiring.devices) if wiring and request.attribute_raw == DEVICE_NAMES else ""
        return messages.GetSystemInfoAttributeStringResponse(value=names)

    @call
    def GetDeviceAttributeString(self, request: Any, context: Any) -> Any:  # noqa: N802
        self._device_exists(request.device_name)
        return messages.GetDeviceAttributeStringResponse(value=PRODUCT_NAME)

    @call
    def GetDeviceAttributeUInt32(self, request: Any, context: Any) -> Any:  # noqa: N802
        self._device_exists(request.device_name)
        return messages.GetDeviceAttributeUInt32Response(value=SERIAL_NUMBER)

    @call
    def GetErrorString(self, request: Any, context: Any) -> Any:  # noqa: N802
        return messages.GetErrorStringResponse(error_string=f"error {request.error_code} of the virtual device")

    @call
    def CreateTask(self, request: Any, context: Any) -> Any:  # noqa: N802
        task = self.device.tasks.create(request.session_name)
        return messages.CreateTaskResponse(task=Session(name=task.session), new_session_initialized=True)

    @call
    def ClearTask(self, request: Any, context: Any) -> Any:  # noqa: N802
        name = request.task.name
        self.device.tasks.clear(name)
        if name in self._watchdogs:
            self._watchdogs.discard(name)
            self.device.watchdog = None
        return messages.ClearTaskResponse()

    @call
    def GetTaskAttributeString(self, request: Any, context: Any) -> Any:  # noqa: N802
        name = self.device.tasks.find(request.task.name).name if request.attribute_raw == TASK_NAME else ""
        return messages.GetTaskAttributeStringResponse(value=name)

    @call
    def CreateAIVoltageChan(self, request: Any, context: Any) -> Any:  # noqa: N802
        self._terminal(request.physical_channel, "ai")
        self.device.tasks.add_channel(request.task.name, "ai", request.physical_channel)
        return messages.CreateAIVoltageChanResponse()

    @call
    def CreateCIAngEncoderChan(self, request: Any, context: Any) -> Any:  # noqa: N802
        self._terminal(request.counter, "ci")
        if request.units_raw != ANGLE_IN_TICKS:
            raise DeviceError(NO_SUCH_CHANNEL, "The virtual device counts in ticks only.")
        task = self.device.tasks.add_channel(request.task.name, "ci", request.counter)
        task.initial = request.initial_angle
        return messages.CreateCIAngEncoderChanResponse()

    @call
    def CreateAOVoltageChan(self, request: Any, context: Any) -> Any:  # noqa: N802
        self._terminal(request.physical_channel, "ao")
        self.device.tasks.add_channel(request.task.name, "ao", request.physical_channel)
        return messages.CreateAOVoltageChanResponse()

    @call
    def CfgSampClkTiming(self, request: Any, context: Any) -> Any:  # noqa: N802
        self.device.tasks.find(request.task.name).rate = request.rate
        return messages.CfgSampClkTimingResponse()

    @call
    def StartTask(self, request: Any, context: Any) -> Any:  # noqa: N802
        self.device.alive()
        task = self.device.tasks.find(request.task.name)
        task.running = True
        if task.kind == "ci":
            self.device.zero(self._encoder(task), round(task.initial))
        if task.kind == "ai":
            self.device.read_at = self.device.samples
        if task.session in self._watchdogs and self.device.watchdog is not None:
            self.device.watchdog.running = True
            self.device.watchdog.last_reset = self.device.samples
        return messages.StartTaskResponse()

    @call
    def StopTask(self, request: Any, context: Any) -> Any:  # noqa: N802
        task = self.device.tasks.find(request.task.name)
        task.running = False
        if task.session in self._watchdogs and self.device.watchdog is not None:
            self.device.watchdog.running = False
        return messages.StopTaskResponse()

    @call
    def ReadAnalogF64(self, request: Any, context: Any) -> Any:  # noqa: N802
        task = self.device.tasks.running(request.task.name, "ai")
        self.device.clock()
        assert self.device.wiring is not None
        names = {one.channel: name for name, one in self.device.wiring.pressures.items()}
        values = [self.device.inputs[names[channel]] for channel in task.channels]
        return messages.ReadAnalogF64Response(read_array=values, samps_per_chan_read=1)

    @call
    def GetReadAttributeUInt64(self, request: Any, context: Any) -> Any:  # noqa: N802
        self.device.tasks.find(request.task.name)
        value = self.device.samples if request.attribute_raw == SAMPLES_ACQUIRED else 0
        return messages.GetReadAttributeUInt64Response(value=value)

    @call
    def ReadCounterScalarF64(self, request: Any, context: Any) -> Any:  # noqa: N802
        task = self.device.tasks.running(request.task.name, "ci")
        self.device.alive()
        return messages.ReadCounterScalarF64Response(value=self.device.counts(self._encoder(task)))

    @call
    def WriteAnalogF64(self, request: Any, context: Any) -> Any:  # noqa: N802
        task = self.device.tasks.find(request.task.name)
        for channel, volts in zip(task.channels, request.write_array, strict=True):
            self.device.write(channel, volts)
        return messages.WriteAnalogF64Response(samps_per_chan_written=1)

    @call
    def CreateWatchdogTimerTaskEx(self, request: Any, context: Any) -> Any:  # noqa: N802
        if self.device.watchdog is not None:
            raise DeviceError(RESERVED, "The specified resource is reserved: the watchdog belongs to another task.")
        task = self.device.tasks.create(request.session_name)
        self._watchdogs.add(task.session)
        self.device.watchdog = Watchdog(max(1, round(request.timeout / PERIOD_S)))
        answer = messages.CreateWatchdogTimerTaskExResponse(task=Session(name=task.session))
        answer.new_session_initialized = True
        return answer

    @call
    def CfgWatchdogAOExpirStates(self, request: Any, context: Any) -> Any:  # noqa: N802
        watchdog = self._watchdog(request)
        names = unflatten_channel_string(request.channel_names)
        for name, volts, kind in zip(names, request.expir_state_array, request.output_type_array, strict=True):
            if kind == VOLTAGE:
                watchdog.states[name] = volts
        return messages.CfgWatchdogAOExpirStatesResponse()

    @call
    def ControlWatchdogTask(self, request: Any, context: Any) -> Any:  # noqa: N802
        self.device.alive()
        self._watchdog(request).last_reset = self.device.samples
        return messages.ControlWatchdogTaskResponse()

    def _watchdog(self, request: Any) -> Watchdog:
        task = self.device.tasks.find(request.task.name)
        if task.session not in self._watchdogs or self.device.watchdog is None:
            raise DeviceError(NO_SUCH_TASK, f"Task '{task.name}' is no watchdog.")
        return self.device.watchdog

    def _encoder(self, task: Task) -> str:
        assert self.device.wiring is not None
        return next(name for name, one in self.device.wiring.encoders.items() if one.channel == task.channels[0])

    def _terminal(self, channel: str, kind: str) -> None:
        self.device.alive()
        wiring = self.device.wiring
        assert wiring is not None
        known: Any = {"ai": wiring.pressures, "ci": wiring.encoders, "ao": wiring.outputs}[kind]
        if channel not in [one.channel for one in known.values()]:
            raise DeviceError(NO_SUCH_CHANNEL, f"Physical channel specified does not exist on this device: {channel}.")

    def _device_exists(self, name: str) -> None:
        if self.device.wiring is None or name not in self.device.wiring.devices:
            raise DeviceError(-200220, f"Device identifier is invalid: {name}.")
