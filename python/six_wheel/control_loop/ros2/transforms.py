"""The message of /tf, with tf2_msgs or without it.

The package index has wheels of the usual messages, and none of tf2_msgs. Its one message, TFMessage, is a
sequence of geometry_msgs/TransformStamped. Messages are sent and taken as bytes here, so the middleware needs
no more of a type than its names, its members and its hash. `stand_in` gives rclpy that: the type support of
geometry_msgs/Polygon, a sequence of Point32, copied with other names and other elements. Layouts are those of
ROS 2 Jazzy: message_type_support_struct.h of rosidl_runtime_c, message_type_support.h of
rosidl_typesupport_fastrtps_cpp and message_introspection.h of rosidl_typesupport_introspection_c.
"""

import ctypes
from collections.abc import Iterable
from functools import cache
from typing import Any

# By REP 2016: of the description of the message in canonical JSON.
HASH = "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
FASTRTPS, INTROSPECTION = b"rosidl_typesupport_fastrtps_c", b"rosidl_typesupport_introspection_c"


class _TypeHash(ctypes.Structure):
    _fields_ = (("version", ctypes.c_uint8), ("value", ctypes.c_uint8 * 32))


class _TypeSupport(ctypes.Structure):
    """rosidl_message_type_support_t."""

    _fields_ = (
        ("identifier", ctypes.c_char_p),
        ("data", ctypes.c_void_p),
        ("handle_function", ctypes.c_void_p),
        ("hash_function", ctypes.c_void_p),
        ("description_function", ctypes.c_void_p),
        ("sources_function", ctypes.c_void_p),
    )


class _Callbacks(ctypes.Structure):
    """message_type_support_callbacks_t."""

    _fields_ = (
        ("namespace", ctypes.c_char_p),
        ("name", ctypes.c_char_p),
        ("functions", ctypes.c_void_p * 4),
        ("key_callbacks", ctypes.c_void_p),
    )


class _Member(ctypes.Structure):
    """rosidl_typesupport_introspection_c__MessageMember."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("type_id", ctypes.c_uint8),
        ("string_upper_bound", ctypes.c_size_t),
        ("elements", ctypes.c_void_p),
        ("is_key", ctypes.c_bool),
        ("is_array", ctypes.c_bool),
        ("array_size", ctypes.c_size_t),
        ("is_upper_bound", ctypes.c_bool),
        ("offset", ctypes.c_uint32),
        ("default", ctypes.c_void_p),
        ("functions", ctypes.c_void_p * 6),
    )


class _Members(ctypes.Structure):
    """rosidl_typesupport_introspection_c__MessageMembers."""

    _fields_ = (
        ("namespace", ctypes.c_char_p),
        ("name", ctypes.c_char_p),
        ("count", ctypes.c_uint32),
        ("size", ctypes.c_size_t),
        ("has_key", ctypes.c_bool),
        ("members", ctypes.c_void_p),
        ("functions", ctypes.c_void_p * 2),
    )


HandleFunction = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p)
HashFunction = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)


def message_type() -> Any:
    """The type of the messages of /tf; None where neither tf2_msgs nor a stand-in can be had."""
    try:
        from tf2_msgs.msg import TFMessage
    except ImportError:
        return stand_in()
    return TFMessage


def decode(message: bytes) -> Iterable[Any]:
    """The transforms of a message: geometry_msgs/TransformStamped."""
    try:
        from tf2_msgs.msg import TFMessage
    except ImportError:
        return _types().deserialize_cdr(message, "tf2_msgs/msg/TFMessage").transforms  # type: ignore[no-any-return]
    from rclpy.serialization import deserialize_message

    return deserialize_message(message, TFMessage).transforms  # type: ignore[no-any-return]


@cache
def _types() -> Any:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


@cache
def stand_in() -> Any:
    """A type that rclpy takes for tf2_msgs/TFMessage in publishers and subscriptions of bytes; None with
    another middleware than Fast DDS, or another layout of its types."""
    from geometry_msgs.msg import Polygon, TransformStamped
    from rclpy.utilities import get_rmw_implementation_identifier

    if get_rmw_implementation_identifier() != "rmw_fastrtps_cpp":
        return None
    fast = _copied(_TypeSupport, _handle(Polygon, FASTRTPS))
    introspection = _copied(_TypeSupport, _handle(Polygon, INTROSPECTION))
    elements = _handle(TransformStamped, INTROSPECTION)
    if fast is None or introspection is None or elements is None:
        return None
    callbacks, members = _copied(_Callbacks, fast.data), _copied(_Members, introspection.data)
    ours = (b"geometry_msgs::msg", b"Polygon"), (b"geometry_msgs__msg", b"Polygon", 1)
    if ((callbacks.namespace, callbacks.name), (members.namespace, members.name, members.count)) != ours:
        return None
    member = _copied(_Member, members.members)
    if (member.name, member.is_array, member.array_size) != (b"points", True, 0):
        return None
    member.name, member.elements = b"transforms", elements
    members.namespace, members.name, members.members = (
        b"tf2_msgs__msg",
        b"TFMessage",
        ctypes.addressof(member),
    )
    callbacks.namespace, callbacks.name = b"tf2_msgs::msg", b"TFMessage"
    type_hash = _TypeHash(1, (ctypes.c_uint8 * 32)(*bytes.fromhex(HASH)))
    hash_function = HashFunction(lambda _: ctypes.addressof(type_hash))
    handles = {FASTRTPS: ctypes.addressof(fast), INTROSPECTION: ctypes.addressof(introspection)}
    handle_function = HandleFunction(lambda _, identifier: handles.get(identifier))
    for support, data in ((fast, callbacks), (introspection, members)):
        support.data = ctypes.addressof(data)
        support.handle_function = ctypes.cast(handle_function, ctypes.c_void_p)
        support.hash_function = ctypes.cast(hash_function, ctypes.c_void_p)
    capsule = ctypes.pythonapi.PyCapsule_New
    capsule.restype = ctypes.py_object
    capsule.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    # Conversions from and to objects, which rclpy wants a type to have, are never called for bytes.
    support_of = {"_TYPE_SUPPORT": capsule(ctypes.addressof(fast), None, None)}
    meta = type("Metaclass_TFMessage", (type(Polygon),), support_of)
    # The type keeps alive what the middleware points to.
    kept = (fast, introspection, callbacks, members, member, hash_function, handle_function)
    return meta("TFMessage", (), {"__module__": "tf2_msgs.msg._tf_message", "__slots__": (), "_kept": kept})


def _handle(kind: Any, identifier: bytes) -> int | None:
    """Address of the type support of a message for one middleware."""
    meta: Any = type(kind)
    if meta._TYPE_SUPPORT is None:
        meta.__import_type_support__()
    pointer = ctypes.pythonapi.PyCapsule_GetPointer
    pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    support = pointer(meta._TYPE_SUPPORT, None)
    found: int | None = HandleFunction(_TypeSupport.from_address(support).handle_function)(
        support, identifier
    )
    return found


def _copied(kind: Any, address: int | None) -> Any:
    return None if address is None else kind.from_buffer_copy(kind.from_address(address))
