# SPDX-License-Identifier: BSD-3-Clause
"""The core's library, loaded by ctypes, and the contexts that its calls take."""
import collections
import ctypes
import glob
import os
import threading
import weakref

import numpy

from . import _declarations as c
from . import _values

_FOLDER = os.path.dirname(os.path.abspath(__file__))
_MISSING = {
    "libgomp": "the OpenMP runtime of gcc (Debian: apt-get install libgomp1; conda: conda install libgomp)",
    "libOpenCL": "the OpenCL loader (Debian: apt-get install ocl-icd-libopencl1; conda: conda install ocl-icd)",
}


class Cancelled(RuntimeError):
    """The progress function asked to stop."""


class DeviceError(RuntimeError):
    """An OpenCL device failed."""


class Unsupported(NotImplementedError):
    """The request is valid, but the core does not implement it."""


_ERRORS = {
    "STRATUS_INVALID_ARGUMENT": ValueError, "STRATUS_OVERFLOW": OverflowError, "STRATUS_OUT_OF_MEMORY": MemoryError,
    "STRATUS_CANCELLED": Cancelled, "STRATUS_NO_DEVICE": ValueError, "STRATUS_DEVICE_ERROR": DeviceError, "STRATUS_UNSUPPORTED": Unsupported,
    "STRATUS_FILE_ERROR": OSError,
}
_ERRORS = {c.ENUMS["stratus_status"][name]: error for name, error in _ERRORS.items()}


def _open(path):
    """Returns the library. Without an OpenCL loader it gets one that knows of no device, so that the host draws."""
    try:
        return ctypes.CDLL(path), ""
    except OSError as error:
        none = os.path.join(_FOLDER, "no_opencl", "libOpenCL.so.1")
        if "libOpenCL" not in str(error) or not os.path.exists(none):
            raise
        ctypes.CDLL(none, mode=ctypes.RTLD_GLOBAL)  # the next load finds it by its name
        return ctypes.CDLL(path), f"no OpenCL device, because {_MISSING['libOpenCL']} is missing: the host draws"


def _load():
    found = sorted(glob.glob(os.path.join(_FOLDER, "libstratus-core.*")))
    if not found:
        raise ImportError(f"stratus_volume has no libstratus-core next to it in {_FOLDER}: it was not built or not installed as a whole")
    try:
        opened, note = _open(found[0])
    except OSError as error:
        for name, what in _MISSING.items():
            if name in str(error) and "cannot open shared object file" in str(error):
                raise ImportError(f"stratus_volume can't load {found[0]}, because {what} is missing ({error})") from None
        raise ImportError(f"stratus_volume can't load {found[0]}: {error}") from None
    for name, (result, parameters) in c.FUNCTIONS.items():
        try:
            function = getattr(opened, name)
        except AttributeError:
            raise ImportError(f"{found[0]} has no {name}: it is not the library that this package was made for") from None
        function.restype, function.argtypes = result, parameters
    return opened, note


library, without_opencl = _load()
version = library.stratus_version().decode()


_of_thread = threading.local()
_PATIENCE = 10  # seconds
_SAME_DEVICE = "a progress function, or an array that is read for a picture, called what uses the same device; it may use another Context"


class _Lock:
    """A lock of a context, as RLock. A thread that reads values for a picture does not wait for that picture forever."""

    def __init__(self):
        self._lock = threading.RLock()

    def __enter__(self):
        if not self._lock.acquire(timeout=_PATIENCE if getattr(_of_thread, "reads", False) else -1):
            raise RuntimeError(_SAME_DEVICE)

    def __exit__(self, *_):
        self._lock.release()

    def try_enter(self):
        return self._lock.acquire(blocking=False)


def reading(reads):
    """Says whether this thread reads values for a picture, which may have the lock of a context."""
    _of_thread.reads = reads


class Context:
    """A device, its threads and its programs. One call at a time uses it: others wait for its lock.

    device   "auto" (the default): the host, or an OpenCL GPU where that draws faster; "host"; or a device's index or part of its name
    threads  on the host, 1..1024; 0 (the default): as many as OpenMP offers, which OMP_NUM_THREADS sets
    """

    made = False  # any of them, in this process

    def __init__(self, device="auto", threads=0):
        self._pointer, self._users, self._left, self._process = None, 0, False, os.getpid()
        self.lock, self._late = _Lock(), collections.deque()
        self._progress, self._raised, self._inside = None, None, False
        options = library.stratus_context_options_default()
        options.device = _text(device, "device")
        options.threads = whole(threads, "threads", 0, 1024)
        if _forked:
            # A fork does not copy the threads of OpenMP or of an OpenCL device: waiting for them would never end.
            if options.threads > 1 or str(device) not in ("auto", "host"):
                raise ValueError(f"device is {device!r} and threads is {threads!r}, they must be 'host' and 1 in a process that was forked off one that "
                                 "had drawn; multiprocessing's method spawn starts processes without this limit")
            options.device, options.threads = b"host", 1
        report = weakref.WeakMethod(self._report)
        self._callback = c.stratus_progress_function(lambda user, stage, fraction: report()(stage, fraction))  # lives as long as the context
        options.progress = self._callback
        pointer, message = ctypes.c_void_p(), ctypes.create_string_buffer(1024)
        status = library.stratus_context_create(ctypes.byref(options), ctypes.byref(pointer), message, len(message))
        if status:
            reason = message.value.decode(errors="replace")
            raise _ERRORS[status](f"{reason} ({without_opencl})" if without_opencl and status == c.STRATUS_NO_DEVICE else reason)
        self._pointer, Context.made = pointer, True

    def _report(self, stage, fraction):
        try:
            # Python handles signals here, so that Ctrl+C ends a long call.
            return int(bool(self._progress and self._progress(stage.decode(), fraction)))
        except BaseException as error:  # ctypes would print it and go on
            self._raised = error
            return 1

    def _destroy_unused(self):
        if self._process != os.getpid():
            return
        while self._late:
            destroy, pointer, _ = self._late.popleft()
            if pointer:
                destroy(pointer)
            self._users -= 1
        if self._left and self._users == 0 and self._pointer:
            library.stratus_context_destroy(self._pointer)
            self._pointer = None

    def __del__(self):
        # Of objects that the garbage collector takes at once, the context may come first. The last object that uses it destroys it then.
        self._left = True
        self._destroy_unused()

    def call(self, function, *arguments, progress=None):
        """Calls a function of the library that returns a status, and raises what the status stands for. Call it with the lock held."""
        if self._process != os.getpid():
            raise RuntimeError("this object was made before the process was forked; make it anew in the child process")
        if self._inside:
            raise RuntimeError(_SAME_DEVICE)
        self._progress, self._raised, self._inside = Progress.of(progress), None, True
        try:
            status = function(*arguments)
        finally:
            self._progress, self._inside = None, False
            self._destroy_unused()
        if self._raised:
            raised, self._raised = self._raised, None
            raise raised
        if status:
            message = library.stratus_context_message(self._pointer) or library.stratus_status_name(status)
            raise _ERRORS.get(status, RuntimeError)(message.decode(errors="replace"))

    @property
    def pointer(self):
        return self._pointer

    @property
    def device(self):
        """The name of the host or device that draws, such as "host (AVX2, 8 threads)"."""
        return library.stratus_context_device(self._pointer).decode(errors="replace")

    def __repr__(self):
        return f"stratus_volume.Context: {self.device}"


class Progress:
    """A function of a stage and a fraction that moves a bar of tqdm's protocol: `total`, `n` and `update(step)`."""

    def __init__(self, bar):
        self.bar, self.done = bar, 0.0

    @classmethod
    def of(cls, progress):
        """Returns a function for the argument `progress`: None, a function, or a bar."""
        if progress is None or callable(progress) and not hasattr(progress, "update"):
            return progress
        if not hasattr(progress, "update"):
            raise TypeError(f"progress is {progress!r}, it must be a function of a stage and a fraction, or a bar with update(), as tqdm's")
        return cls(progress)

    def __call__(self, stage, fraction):
        total = getattr(self.bar, "total", None) or 1.0
        if fraction > self.done:  # stages begin anew, but a bar only moves forward
            self.bar.update((fraction - self.done) * total)
            self.done = fraction
        if hasattr(self.bar, "set_description"):
            self.bar.set_description(stage, refresh=False)


_contexts, _lock = {}, threading.Lock()
_forked, _of_parent = False, []


def _after_fork():
    global _contexts, _lock, _forked
    _of_parent.append(_contexts)  # not to be destroyed here
    _forked = _forked or bool(_contexts) or Context.made
    _contexts, _lock = {}, threading.Lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)


def context(device=None, threads=None):
    """Returns the context of a device, which all calls share that name the same. device may be a Context of one's own."""
    if isinstance(device, Context):
        if threads is not None:
            raise ValueError(f"threads is {threads!r}, but a Context has its own")
        return device
    key = (str("auto" if device is None else device), 0 if threads is None else threads)
    with _lock:
        if key not in _contexts:
            _contexts[key] = Context(*key)
        return _contexts[key]


def color_maps():
    """Returns the names of the colour maps that need no other package: matplotlib's, cmocean's, ParaView's and Stratus' own. Any of them
    with "_r" at its end is reversed."""
    names = []
    while name := library.stratus_color_map_name(len(names)):
        names.append(name.decode())
    return names


def _core_map(name):
    """The rows (256, 3) of red, green and blue in 0..1 of a colour map of the core, or None for another name."""
    points, owner = numpy.empty((c.CONSTANTS["STRATUS_COLOR_MAP_COLORS"], 4)), context("host", 1)
    with owner.lock:
        try:
            owner.call(library.stratus_color_map_points, owner.pointer, name.encode(), 0.0, 1.0, address(points))
        except ValueError:
            return None
    return points[:, 1:]


_values.core_map, _values.core_map_names = _core_map, color_maps


def devices():
    """Returns the names of this machine's OpenCL devices, [] where there is none. The host needs none."""
    names = []
    for index in range(library.stratus_device_count()):
        name = ctypes.create_string_buffer(256)
        library.stratus_device_name(index, name, len(name))
        names.append(name.value.decode(errors="replace"))
    return names


class Owned:
    """An object of the core with the function that frees it; it keeps its context alive, and `keep` as long as the object."""

    def __init__(self, owner, destroy, keep=None):
        self.owner, self.pointer, self._destroy, self._keep = owner, ctypes.c_void_p(), destroy, keep
        with owner.lock:
            owner._users += 1

    def __del__(self):
        if self.owner._process != os.getpid():
            return  # it belongs to the process that this one was forked off
        # The garbage collector may call this in a thread that reads values for a picture, which has the lock: the picture's call frees it then.
        self.owner._late.append((self._destroy, self.pointer, self._keep))
        if self.owner.lock.try_enter():
            try:
                self.owner._destroy_unused()
            finally:
                self.owner.lock.__exit__()


def _text(value, name):
    if not isinstance(value, (str, int)) or isinstance(value, bool):
        raise TypeError(f"{name} is {value!r}, it must be a text or an index")
    return str(value).encode()


def whole(value, name, low, high):
    try:
        same = int(value) == value
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name} is {value!r}, it must be a whole number in {low}..{high}") from None
    if not same or not low <= value <= high:
        raise ValueError(f"{name} is {value!r}, it must be a whole number in {low}..{high}")
    return int(value)


def choice(value, enum, prefix, name, leave_out=()):
    """Returns the number of an enum's entry by its name in lower case, with hyphens."""
    names = {entry[len(prefix):].lower().replace("_", "-"): number for entry, number in c.ENUMS[enum].items()}
    names = {entry: number for entry, number in names.items() if entry not in leave_out}
    if not isinstance(value, str) or value.replace("_", "-") not in names:
        raise ValueError(f"{name} is {value!r}, it must be one of {', '.join(names)}")
    return names[value.replace("_", "-")]


def name_of(value, enum, prefix):
    for entry, number in c.ENUMS[enum].items():
        if number == value:
            return entry[len(prefix):].lower().replace("_", "-")
    return str(value)


_NAMED = {"stratus_ray_cast_report": {"structure": ("stratus_structure", "STRATUS_STRUCTURE_"), "sampling": ("stratus_sampling", "STRATUS_SAMPLING_")},
          "stratus_tetra_report": {"method": ("stratus_tetra_method", "STRATUS_TETRA_METHOD_")},
          "stratus_tree_statistics": {"method": ("stratus_tree_method", "STRATUS_TREE_")}}


def as_dict(struct):
    """A report as a dict: texts as str, arrays as tuples, enums by their names."""
    named, result = _NAMED.get(type(struct).__name__, {}), {}
    for field, *_ in struct._fields_:
        value = getattr(struct, field)
        if field in named:
            value = name_of(value, *named[field])
        elif isinstance(value, bytes):
            value = value.decode(errors="replace")
        elif isinstance(value, ctypes.Array):
            value = tuple(value)
        result[field] = value
    return result


def address(array):
    return None if array is None else array.ctypes.data


_LETTERS = {"int": "i", "uint": "u", "float": "f"}
_TYPES = {letter + str(bits // 8): c.ENUMS["stratus_type"][f"STRATUS_{name.upper()}{bits}"] for name, letter in _LETTERS.items()
          for bits in (8, 16, 32, 64) if letter != "f" or bits > 16}


def type_of(array):
    """The core's number of an array's type."""
    return _TYPES[array.dtype.kind + str(array.dtype.itemsize)]
