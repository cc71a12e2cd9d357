"""Pinocchio's C++ library behind a C function, compiled once an environment."""

import ctypes
import hashlib
import os
import subprocess
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))


def library(cache, progress):
    """The function, compiled into the directory `cache` where it is not there yet."""
    source = os.path.join(HERE, "pinocchio_shim.cpp")
    # Another text has a library of its own.
    with open(source, "rb") as file:
        key = hashlib.sha256(file.read()).hexdigest()[:12]
    path = os.path.join(cache, f"pinocchio_shim_{key}.so")
    if not os.path.exists(path):
        progress("compiling Pinocchio's C++ (some minutes, once)")
        prefix = os.path.join(sys.prefix, "lib", f"python3.{sys.version_info.minor}", "site-packages", "cmeel.prefix")
        include = os.path.join(prefix, "include")
        eigen = os.path.join(include, "eigen3")
        draft = f"{path}.{os.getpid()}"
        command = [
            os.environ.get("CXX", "c++"), "-std=c++17", "-O3", "-march=native", "-DNDEBUG", "-shared", "-fPIC",
            "-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
            f"-I{include}", f"-I{eigen}", source,
            f"-L{prefix}/lib", "-lpinocchio_default", f"-Wl,-rpath,{prefix}/lib", "-o", draft,
        ]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"its C++ does not compile: {done.stderr.strip().splitlines()[-1] if done.stderr else done.returncode}")
        os.replace(draft, path)
    run = ctypes.CDLL(path).run
    run.restype = None

    def call(parents, kinds, numbers, loops, springs, torques, gravity, q0, v0, end, steps, samples, w, out):
        keep = []

        def doubles(values):
            keep.append(np.ascontiguousarray(values, dtype=float))
            return keep[-1].ctypes.data_as(ctypes.POINTER(ctypes.c_double))

        def integers(values):
            keep.append(np.ascontiguousarray(values, dtype=np.int32))
            return keep[-1].ctypes.data_as(ctypes.POINTER(ctypes.c_int))

        run(
            ctypes.c_int(len(parents)), integers(parents), integers(kinds), doubles(numbers),
            ctypes.c_int(len(loops)), doubles(loops), ctypes.c_int(len(springs)), doubles(springs),
            doubles(torques), doubles(gravity), doubles(q0), doubles(v0), ctypes.c_double(end),
            ctypes.c_int(steps), ctypes.c_int(samples), ctypes.c_double(w),
            out.ctypes.data_as(ctypes.POINTER(ctypes.c_double)),
        )

    return call
