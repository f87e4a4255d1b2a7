"""control_msgs/SetOdometry for tests: the package index has no wheel of control_msgs.

Its request is six numbers, as geometry_msgs/Twist is in memory and on the wire; its response is that of
std_srvs/Trigger. So its type support is that of Trigger with the request of Twist. Layouts are those of ROS 2
Jazzy: service_type_support_struct.h of rosidl_runtime_c, service_type_support.h of
rosidl_typesupport_fastrtps_cpp.
"""

import ctypes
from typing import Any

from geometry_msgs.msg import Twist
from std_srvs.srv import Trigger

from six_wheel.control_loop.ros2 import transforms

FIELDS = ("x", "y", "z", "roll", "pitch", "yaw")
Numbers = ctypes.c_double * len(FIELDS)


class ServiceSupport(ctypes.Structure):
    """rosidl_service_type_support_t."""

    _fields_ = (
        ("identifier", ctypes.c_char_p),
        ("data", ctypes.c_void_p),
        ("handle_function", ctypes.c_void_p),
        ("messages", ctypes.c_void_p * 3),
        ("event_functions", ctypes.c_void_p * 2),
        ("description_functions", ctypes.c_void_p * 3),
    )


class ServiceCallbacks(ctypes.Structure):
    """service_type_support_callbacks_t."""

    _fields_ = (
        ("namespace", ctypes.c_char_p),
        ("name", ctypes.c_char_p),
        ("request", ctypes.c_void_p),
        ("response", ctypes.c_void_p),
    )


FromPython = ctypes.PYFUNCTYPE(ctypes.c_bool, ctypes.py_object, ctypes.c_void_p)
ToPython = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p)


def capsule(address: int | None) -> Any:
    new = ctypes.pythonapi.PyCapsule_New
    new.restype, new.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    return new(address, None, None)


def support() -> tuple[Any, ...]:
    """The type support for Fast DDS, and what it points to."""
    type(Trigger).__import_type_support__()
    pointer = ctypes.pythonapi.PyCapsule_GetPointer
    pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    general = pointer(type(Trigger)._TYPE_SUPPORT, None)
    handle = transforms.HandleFunction(ServiceSupport.from_address(general).handle_function)
    fast = ServiceSupport.from_buffer_copy(ServiceSupport.from_address(handle(general, transforms.FASTRTPS)))
    callbacks = ServiceCallbacks.from_buffer_copy(ServiceCallbacks.from_address(fast.data))
    assert (callbacks.namespace, callbacks.name) == (b"std_srvs::srv", b"Trigger")
    callbacks.namespace, callbacks.name = b"control_msgs::srv", b"SetOdometry"
    callbacks.request = transforms._handle(Twist, transforms.FASTRTPS)
    itself = transforms.HandleFunction(
        lambda _, identifier: ctypes.addressof(fast) if identifier == transforms.FASTRTPS else None
    )
    fast.data, fast.handle_function = ctypes.addressof(callbacks), ctypes.cast(itself, ctypes.c_void_p)
    return fast, callbacks, itself


KEPT = support()


@FromPython
def write(request: Any, address: int) -> bool:
    Numbers.from_address(address)[:] = [float(getattr(request, field)) for field in FIELDS]
    return True


@ToPython
def read(address: int) -> Any:
    return Request(**dict(zip(FIELDS, Numbers.from_address(address), strict=True)))


class RequestType(type):
    """Attributes that rclpy needs of the class of a message class."""

    _TYPE_SUPPORT = type(Twist)._TYPE_SUPPORT
    _CREATE_ROS_MESSAGE = type(Twist)._CREATE_ROS_MESSAGE
    _DESTROY_ROS_MESSAGE = type(Twist)._DESTROY_ROS_MESSAGE
    _CONVERT_FROM_PY = capsule(ctypes.cast(write, ctypes.c_void_p).value)
    _CONVERT_TO_PY = capsule(ctypes.cast(read, ctypes.c_void_p).value)


class Request(metaclass=RequestType):
    """The request."""

    def __init__(self, **given: float) -> None:
        self.x = self.y = self.z = self.roll = self.pitch = self.yaw = 0.0
        for field, value in given.items():
            setattr(self, field, value)


class ServiceType(type):
    """Attributes that rclpy needs of the class of a service class."""

    _TYPE_SUPPORT = capsule(ctypes.addressof(KEPT[0]))


class SetOdometry(metaclass=ServiceType):
    """The service."""

    Request, Response, Event = Request, Trigger.Response, Trigger.Event
