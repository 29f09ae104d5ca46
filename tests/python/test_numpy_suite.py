# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""bit_generator: NumPy's own tests of its bit generators, run against ours from the NumPy that is installed.

The classes of `numpy.random.tests.test_direct` and `test_smoke` for MT19937, PCG64DXSM, SFC64 and Philox, each with
our generator of the method in the place of NumPy's. What is left out, and why, stands in EXCLUDED.
"""

from typing import Any

import numpy as np
import pytest

from sunfleck.bit_generator import BitGenerator

direct: Any = pytest.importorskip("numpy.random.tests.test_direct")
smoke: Any = pytest.importorskip("numpy.random.tests.test_smoke")

NAMES = {"MT19937": "mt19937", "PCG64DXSM": "pcg64dxsm", "SFC64": "sfc64", "Philox": "philox4x64"}

CONSTRUCTOR = "our constructor takes a name and a seed, no key and no counter"
STATES = "a state that is no mapping is a ValueError here, as every other bad state is"
LEGACY = "seeds RandomState by a method that only NumPy's own MT19937 has"
EXCLUDED: dict[tuple[str, str], str] = {
    **{(name, "test_invalid_state_type"): STATES for name in NAMES},
    ("Philox", "test_set_key"): CONSTRUCTOR,
    ("Philox", "test_invalid_init_values"): CONSTRUCTOR,
    ("SFC64", "test_jump"): "asks whether there is a `jumped` at all; ours is there and raises NotImplementedError",
    ("SFC64", "test_advance"): "as test_jump",
}


def ours_called(numpy_name: str) -> type[BitGenerator]:
    """A class whose constructor takes a seed alone, and that is called as NumPy's is."""

    def begin(self: BitGenerator, seed: Any = None) -> None:
        BitGenerator.__init__(self, NAMES[numpy_name], seed)

    return type(numpy_name, (BitGenerator,), {"__init__": begin})


def direct_suite(numpy_name: str) -> type:
    base = getattr(direct, f"Test{numpy_name}")

    def setup_class(cls: Any) -> None:
        base.setup_class.__func__(cls)
        cls.bit_generator = ours_called(numpy_name)

    return type(f"TestDirect{numpy_name}", (base,), {"setup_class": classmethod(setup_class)})


def smoke_suite(numpy_name: str) -> type:
    base = getattr(smoke, f"Test{numpy_name}")

    def create(cls: Any) -> Any:
        data = base._create_rng.__func__(cls)
        data.bit_generator = ours_called(numpy_name)
        data.rg = np.random.Generator(data.bit_generator(*data.seed))
        if data.advance is None:
            data.advance = 1  # for those of NumPy's that have no `advance`
        return data

    return type(f"TestSmoke{numpy_name}", (base,), {"_create_rng": classmethod(create)})


for _name in NAMES:
    for _suite in (direct_suite(_name), smoke_suite(_name)):
        for (_excluded, _test), _why in EXCLUDED.items():
            if _excluded == _name and hasattr(_suite, _test):
                setattr(_suite, _test, None)
        globals()[_suite.__name__] = _suite


def test_what_is_excluded_exists() -> None:
    for name, test in EXCLUDED:
        assert any(hasattr(getattr(module, f"Test{name}"), test) for module in (direct, smoke)), (name, test)
