"""The judge of contact records, and pictures."""
import json
import os
import subprocess
import sys

import numpy as np
import pdepth
import pytest

BOX = pdepth.Box([1, 1, 1])
HEAD = {"record": "pdepth-contacts/1", "engine": "test", "scalar": "float64"}
SHAPES = [{"shape": "box", "is": BOX}]


def contact(number, gap, reported):
    return {"contact": number, "a": "box", "b": "box", "pose_b": pdepth.Pose(translation=[2 + gap, 0, 0]), "reported": reported}


def test_the_judge_names_misses_phantoms_and_errors(tmp_path):
    right = contact(1, -0.5, {"depth": 0.5, "normal": [-1, 0, 0]})
    records = [HEAD, *SHAPES, right, contact(2, -0.25, None), contact(3, 0.25, {"depth": 0.1}), contact(4, -0.5, {"depth": 0.25})]
    found = pdepth.audit(records, fail_on="missed=0")
    assert (found.contacts, found.judged, found.missed, found.phantom) == (4, 4, 1, 1) and not found.ok
    assert "missed" in found.table
    file = tmp_path / "contacts.jsonl"
    file.write_text(json.dumps(HEAD) + "\n" + json.dumps({"shape": "box", "is": BOX.protocol()}) + "\n")
    assert pdepth.audit(file).contacts == 0
    assert pdepth.audit([HEAD, *SHAPES, right], fail_on="missed=0,phantom=0,depth_error=1e-12").ok


def test_a_record_that_cannot_be_read_is_refused_by_its_number():
    with pytest.raises(pdepth.Refused) as caught:
        pdepth.audit([HEAD, *SHAPES, {"contact": 1, "a": "box", "b": "ball", "reported": None}])
    assert caught.value.where.startswith("records[2]")
    with pytest.raises(pdepth.Refused, match=r"records\[1\]"):
        pdepth.audit([HEAD, {"shape": "s", "is": {"type": "sphere", "radius": float("nan")}}])
    with pytest.raises(pdepth.Refused, match="unreadable_file"):
        pdepth.audit("no/such.jsonl")


def test_pictures_show_both_bodies_and_the_way_out():
    pytest.importorskip("pdepth._picture", reason="built without the renderer")
    rgb = pdepth.picture(BOX, pdepth.Sphere(1), pose_b=pdepth.Pose(translation=[1.5, 0, 0.5]), size=(320, 180))
    assert rgb.shape == (180, 320, 3) and rgb.dtype == np.uint8
    blue = (rgb[..., 2].astype(int) - rgb[..., 0] > 25).sum()
    amber = (rgb[..., 0].astype(int) - rgb[..., 2] > 40).sum()
    assert blue > 500 and amber > 500
    assert pdepth.picture(BOX, BOX, pose_b=pdepth.Pose(translation=[1, 0, 0]), size=(640, 360), difference=True).std() > 5
    assert BOX._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n"
    with pytest.raises(pdepth.Refused, match="without margins"):
        pdepth.picture(BOX, pdepth.Sphere(1), difference=True)
    with pytest.raises(pdepth.Refused, match="size"):
        pdepth.picture(BOX, size=(4, 4))


def test_without_a_rasteriser_a_picture_is_a_named_error():
    pytest.importorskip("pdepth._picture", reason="built without the renderer")
    script = ("import sys, pdepth\nsys.modules['pdepth._picture'] = None\n"
              "try:\n    pdepth.picture(pdepth.Sphere(1))\nexcept pdepth.Refused as error:\n    print(error.code)\n")
    environment = {**os.environ, "PYTHONPATH": os.path.dirname(os.path.dirname(pdepth.__file__))}
    told = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "unsupported"
