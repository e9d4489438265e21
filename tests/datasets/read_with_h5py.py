# SPDX-License-Identifier: BSD-3-Clause
"""read_with_h5py.py PROGRAM FORMATS: reads what write_sample_record writes, as a user of h5py would, also by the example in
docs/formats.md."""

import contextlib
import io
import math
import os
import subprocess
import sys
import tempfile

import h5py
import numpy as np


def as_a_viewer_would(root):
    """Follows @default down to the NXdata group, as NeXus has it."""
    group = root
    while text(group, "NX_class") != "NXdata":
        group = group[text(group, "default")]
    return group


def text(owner, name):
    """An attribute of fixed length, which h5py gives as bytes."""
    return owner.attrs[name].decode()


def check(root):
    assert text(root, "format") == "impactrig-recording"
    assert text(root, "format_version") == "1.0"
    assert text(root, "creator").startswith("impactrig ")

    entry = root["entry"]
    assert text(entry, "NX_class") == "NXentry"
    assert entry["title"].asstr()[()] == "Beam on groove, shot 7"
    assert entry["start_time"].asstr()[()] == "2006-05-04T10:11:12+08:00"
    assert list(entry["warnings"].asstr()[()]) == ["Two samples are clipped.", "Zeit läuft rückwärts"]
    assert dict(entry["attributes"].asstr()[()]) == {"operator": "Li 李", "empty": "", "a/b @ c": "1\n2"}

    # raw counts and their scale
    raw = entry["raw"]
    assert list(raw) == ["force", "velocity_beam", "h1"]
    force = raw["force"]
    assert force["name"].asstr()[()] == "Force" and force["quantity"].asstr()[()] == "force"
    assert raw["velocity_beam"]["name"].asstr()[()] == "Velocity / beam"
    samples = force["samples"]
    assert samples.dtype == np.int16 and samples.shape == (2000,)
    assert samples.compression == "gzip" and samples.shuffle and samples.fletcher32
    assert text(samples, "units") == "1" and text(samples, "physical_units") == "kN"
    values = samples[()] * samples.attrs["scale_factor"] + samples.attrs["add_offset"]
    assert abs(values[200] - 1.501) < 1e-12
    times = samples.attrs["start"] + samples.attrs["interval"] * np.arange(samples.size)
    assert force["valid"][()].sum() == 1999 and force["valid"][5] == 0
    assert dict(force["attributes"].asstr()[()])["Überlast"] == "nein"
    velocity = raw["velocity_beam"]
    assert velocity["samples"].dtype == np.float32
    assert text(velocity["samples"], "units") == "m/s"
    assert list(velocity["times"][()]) == [0.0, 1e-6, 3e-6]
    assert raw["h1"]["imaginary"][0] == 0.5 and math.isnan(raw["h1"]["imaginary"][1])

    # what a viewer draws: SI values over seconds
    look = as_a_viewer_would(root)
    assert look.name == "/entry/quicklook/force"
    signal = look[text(look, "signal")]
    axis = look[look.attrs["axes"][0].decode()]
    assert text(signal, "units") == "N" and text(axis, "units") == "s"
    assert text(signal, "long_name") == "Force (N)"
    assert np.allclose(axis[()], times, rtol=0, atol=1e-18)
    sound = force["valid"][()] == 1
    assert np.allclose(signal[()][sound], 1000 * values[sound], rtol=1e-15)
    assert math.isnan(signal[5])
    assert signal.dims[0].keys() == ["time"] and signal.dims[0]["time"] == axis
    assert h5py.h5ds.is_scale(axis.id)

    complex_look = entry["quicklook/h1"]
    assert list(complex_look.attrs["auxiliary_signals"]) == [b"imaginary"]
    assert complex_look["imaginary"].dims[0]["time"] == complex_look["time"]

    # calibration and provenance
    calibration = entry["calibration/force"]
    assert calibration["sensitivity"][()] == 4e-3
    assert text(calibration["sensitivity"], "units") == "V/N"
    assert calibration["sensitivity_errors"][()] == 2e-5
    assert calibration["delay"][()] == 2.3e-6 and calibration["delay"].attrs["removed"] == 1
    provenance = entry["provenance"]
    assert provenance["bytes"][()] == 123456789012
    assert provenance["importer"].asstr()[()] == "uff58b"
    edits = provenance["edits"]
    assert [edits[name]["what"].asstr()[()] for name in edits] == ["remove baseline", "remove delay"]
    assert dict(edits["edit_000000/parameters"].asstr()[()]) == {"offset": "0.012 V"}


with open(sys.argv[2], encoding="utf-8") as page:
    example = page.read().split("```python\n")[1].split("```")[0]

with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    subprocess.run([sys.argv[1], "shot.h5"], check=True)
    with h5py.File("shot.h5", "r") as root:
        check(root)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(example, {})
    assert printed.getvalue().splitlines() == [
        "Force kN -0.0001 1.501",
        "Velocity / beam m/s 0.0 inf",
        "H1 (m/s)/N 0.0 1.0",
        "{'serial': '2626-1', 'Überlast': 'nein'}",
        "N",
    ], printed.getvalue()
    os.chdir(os.path.dirname(folder))
