"""Files that are no REXS models, or mean harm: one line each, in little memory."""

from __future__ import annotations

import json
import random
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from own_rexs import json_text, one_stage, put, replaced, xml
from thermogear import InputError, read_rexs
from thermogear.case.rexs.container import model_of
from thermogear.case.rexs.importing import imported, listed, shafts
from thermogear.front.cli import main

Made = Callable[[Path], Path]


def whole() -> str:
    return xml(*one_stage())


def laughs(folder: Path) -> Path:
    entities = "".join(
        f'<!ENTITY l{k} "{("&l" + str(k - 1) + ";") * 10 if k else "lol"}">' for k in range(10)
    )
    text = whole().replace("?><model", f"?><!DOCTYPE model [{entities}]><model")
    return put(folder, text.replace("tests", "&l9;", 1))


def external(folder: Path) -> Path:
    doctype = '<!DOCTYPE model SYSTEM "file:///etc/passwd"><model'
    return put(folder, whole().replace("<model", doctype, 1))


def zip_of(folder: Path, *entries: tuple[str, bytes]) -> Path:
    path = folder / "gearbox.rexsz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in entries:
            archive.writestr(name, content)
    return path


def bomb(folder: Path) -> Path:
    return zip_of(folder, ("gearbox.rexs", b"\0" * 50_000_000))


def lying_bomb(folder: Path) -> Path:
    """Its directory says that 100 bytes come out of it."""
    path = bomb(folder)
    raw = path.read_bytes()
    path.write_bytes(raw.replace((50_000_000).to_bytes(4, "little"), (100).to_bytes(4, "little")))
    return path


def many_nodes(folder: Path) -> Path:
    text = whole().replace("</components>", "<a/>" * 10_000_000 + "</components>")
    return put(folder, text)


def many_values(folder: Path) -> Path:
    return put(folder, '{"model":{"version":"1.7","x":[' + "0," * 10_000_000 + "0]}}")


def deep(folder: Path) -> Path:
    return put(folder, '<model version="1.7">' + "<a>" * 100_000 + "</a>" * 100_000 + "</model>")


def deep_json(folder: Path) -> Path:
    return put(folder, '{"model":' * 100_000 + "0" + "}" * 100_000)


def no_gears(folder: Path) -> Path:
    parts, links = one_stage()
    return put(folder, xml(parts, [one for one in links if one[0] != "stage"]))


def text_for_number(folder: Path) -> Path:
    parts, links = one_stage()
    return put(folder, xml(replaced(parts, 7, ("normal_module", "mm", "two and a half")), links))


def truth_for_number(folder: Path) -> Path:
    parts, links = one_stage()
    return put(folder, json_text(replaced(parts, 7, ("normal_module", "mm", True)), links))


def not_a_number(folder: Path) -> Path:
    return put(folder, json_text(*one_stage()).replace("80.9", "NaN"))


def half_a_tooth(folder: Path) -> Path:
    parts, links = one_stage()
    return put(folder, xml(replaced(parts, 7, ("number_of_teeth", "none", 20.5)), links))


def no_unit_at_all(folder: Path) -> Path:
    parts, links = one_stage()
    return put(folder, xml(replaced(parts, 3, ("center_distance", "9**9**9", 80.9)), links))


def unknown_version(folder: Path) -> Path:
    return put(folder, whole().replace('version="1.7"', 'version="1.10"'))


def broken_off(folder: Path) -> Path:
    return put(folder, whole()[:-200])


def broken_json(folder: Path) -> Path:
    return put(folder, json_text(*one_stage())[:-3])


def out_of_the_zip(folder: Path) -> Path:
    return zip_of(folder, ("gearbox.rexs", whole().encode()), ("../evil", b"x"))


def two_in_a_zip(folder: Path) -> Path:
    return zip_of(folder, ("a.rexs", whole().encode()), ("b.rexs", whole().encode()))


def cut_zip(folder: Path) -> Path:
    path = zip_of(folder, ("gearbox.rexs", whole().encode()))
    path.write_bytes(path.read_bytes()[:300])
    return path


def twice(folder: Path) -> Path:
    parts, links = one_stage()
    return put(folder, xml([*parts, parts[0]], links))


def utf16(folder: Path) -> Path:
    path = folder / "gearbox.rexs"
    path.write_bytes(whole().encode("utf-16"))
    return path


def other_file(folder: Path) -> Path:
    return put(folder, "module = 3\n")


def nothing(folder: Path) -> Path:
    return put(folder, "")


def other_xml(folder: Path) -> Path:
    return put(folder, "<html><body/></html>")


def list_for_model(folder: Path) -> Path:
    return put(folder, '{"model": {"version": "1.7", "components": {"id": 1}}}')


HOSTILE: dict[str, tuple[Made, str]] = {
    "entity expansion": (laughs, "line 1: REXS file: got a DOCTYPE; allowed none"),
    "external entity": (external, "line 1: REXS file: got a DOCTYPE; allowed none"),
    "zip bomb": (bomb, "REXS file: got a zip that unpacks 'gearbox.rexs' to 50000000 bytes"),
    "lying zip bomb": (lying_bomb, "REXS file: got a zip that cannot be unpacked"),
    "ten million nodes": (many_nodes, "REXS file: got more than 2000000 nodes"),
    "ten million values": (many_values, "REXS file: got more than 2000000 nodes"),
    "deep nesting": (deep, "REXS file: got elements 32 deep"),
    "deep nesting in JSON": (deep_json, "REXS file: got a number or a nesting beyond reason"),
    "a stage without gears": (no_gears, "stage 1.gears: got no gear; allowed gear_1 and gear_2"),
    "text for a number": (text_for_number, "normal_module: got 'two and a half'; allowed a number"),
    "a truth for a number": (truth_for_number, "normal_module: got true; allowed a number"),
    "not a number": (not_a_number, "REXS file: got NaN; allowed finite numbers"),
    "half a tooth": (half_a_tooth, "number_of_teeth: got '20.5'; allowed a whole number"),
    "a unit that is none": (no_unit_at_all, "center_distance: got 80.9 9**9**9; allowed a unit of"),
    "an unknown version": (unknown_version, "model.version: got '1.10'; allowed 1.0 | 1.1"),
    "XML that breaks off": (broken_off, "REXS file: got XML that breaks off in line 1"),
    "JSON that breaks off": (broken_json, "REXS file: got JSON that breaks off in line 1"),
    "a name out of the zip": (out_of_the_zip, "REXS file: got the name '../evil' in a zip"),
    "two models": (two_in_a_zip, "REXS file: got a zip with 2 models; allowed one model"),
    "half a zip": (cut_zip, "REXS file: got a zip that cannot be unpacked"),
    "an id twice": (twice, "component 1: got an id twice"),
    "UTF-16": (utf16, "REXS file: got UTF-16 text; allowed UTF-8"),
    "another file": (other_file, "REXS file: got 'module = 3"),
    "an empty file": (nothing, "REXS file: got an empty file"),
    "other XML": (other_xml, "REXS file: got the element 'html'; allowed 'model'"),
    "tables where lists belong": (list_for_model, "components: got"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_one_line(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made, said = HOSTILE[name]
    path = made(tmp_path)
    assert main(["import", str(path), "--stage", "1", "-o", str(tmp_path / "mine.toml")]) == 2
    heard = capsys.readouterr()
    assert heard.out == ""
    assert len(heard.err.splitlines()) == 1, heard.err
    assert said in heard.err
    assert len(heard.err) < 400
    assert not (tmp_path / "mine.toml").exists()


@pytest.mark.parametrize(
    "made", [laughs, bomb, lying_bomb, many_nodes, many_values, deep, deep_json]
)
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="Linux tells the peak there")
def test_bounded_memory(made: Made, tmp_path: Path) -> None:
    """Less than 300 MB more than Python itself, where the file alone is up to 40 MB."""
    path = made(tmp_path)
    code = (
        "import sys\n"
        "from pathlib import Path\n"
        "from thermogear import InputError, read_rexs\n"
        "def most() -> int:\n"
        "    text = Path('/proc/self/status').read_text()\n"
        "    return int(text.split('VmHWM:')[1].split()[0])\n"
        "before = most()\n"
        "try:\n    read_rexs(sys.argv[1])\nexcept InputError as error:\n    print(error)\n"
        "print(most() - before)\n"
    )
    told = subprocess.run(
        [sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert len(told) == 2
    assert int(told[1]) < 300_000


def test_ids_may_jump_and_names_may_hold_anything(tmp_path: Path) -> None:
    parts, links = one_stage()
    text = xml(parts, links).replace('id="3" type', 'id="3" name="a&#10;b&quot; = 1" type')
    found = imported(read_rexs(put(tmp_path, text)), 1)
    assert 'title = "a b\\" = 1"' in found.text


def test_a_stage_that_is_not_there(tmp_path: Path) -> None:
    path = put(tmp_path, whole())
    for number in (0, 4, -1):
        with pytest.raises(InputError, match=r"--stage: got -?\d; allowed 1..1"):
            imported(read_rexs(path), number)
    parts, links = one_stage()
    parts = [part for part in parts if part[1] != "cylindrical_stage"]
    with pytest.raises(InputError, match="REXS file: got no cylindrical stage"):
        imported(read_rexs(put(tmp_path, xml(parts, links))))


def test_a_thousand_stages_are_listed_in_little_time(tmp_path: Path) -> None:
    parts, links = one_stage()
    for k in range(2000):
        parts.append((1000 + k, "cylindrical_stage", []))
        links.append(("stage", [("stage", 1000 + k), ("gear_1", 7), ("gear_2", 9)]))
    path = put(tmp_path, json_text(parts, links))
    assert main(["import", str(path)]) == 0
    assert json.loads(path.read_text())["model"]["version"] == "1.7"


@pytest.mark.filterwarnings("ignore::thermogear.ValidityWarning")
def test_values_put_wrong_by_chance_are_a_case_or_one_line(tmp_path: Path) -> None:
    """A seeded sample of models of which one or two values are something else."""
    draw = random.Random(20260131)
    wrong = [0, -1, 1e308, 1e-308, "", "x", None, [], [1, 2], "1,5", "nan", 10**400, True, "c99"]
    keys = ("floating_point", "integer", "string", "boolean", "unit", "role", "id", "type")
    cases = 0
    for _ in range(150):
        tree = json.loads(json_text(*one_stage()))
        places = list(found(tree, keys))
        for table, key in draw.sample(places, draw.randint(1, 2)):
            table[key] = draw.choice(wrong)
        raw = json.dumps(tree).encode()
        said = ""
        try:
            model = model_of(raw)
            listed(model)
            shafts(model)
            imported(model, 1)
        except InputError as error:
            said = str(error)
        assert "\n" not in said
        assert len(said) < 600
        cases += not said
    assert 20 < cases < 130


def found(node: Any, keys: tuple[str, ...]) -> Iterator[tuple[dict[str, Any], str]]:
    """Every table and key below ``node`` whose key is one of ``keys``."""
    inside = node.items() if isinstance(node, dict) else enumerate(node)
    for key, value in inside:
        if key in keys:
            yield node, str(key)
        elif isinstance(value, dict | list):
            yield from found(value, keys)
