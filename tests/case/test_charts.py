"""Measured flanks: read from a chart, evaluated, smoothed, kept with the case."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import own_chart
from own_chart import BASE, END, START, chart, diameter
from thermogear.base.errors import InputError
from thermogear.base.period import Period
from thermogear.case.case import GearCase, load_case
from thermogear.case.family import family
from thermogear.gears.deviations import GEARS, FlankTable, PitchError
from thermogear.gears.graded_flanks import WavyProfile, profile_figures

Floats = NDArray[np.float64]

RHO = np.linspace(START, END, 241)
SHARE = (RHO - START) / (END - START)
TRACE = 6.0 * (SHARE - 0.5) + 2.0 * np.sin(2.0 * math.pi * 2.5 * SHARE)
LEFT, RIGHT = "tooth 1 left [um]", "tooth 1 right [um]"


def table_of(case: GearCase, gear: str, flank: str) -> FlankTable:
    found = [
        one
        for one in case.deviations
        if isinstance(one, FlankTable) and (one.gear, one.flank) == (gear, flank)
    ]
    assert len(found) == 1
    return found[0]


def acts(case: GearCase, flank: str = "drive", rho: Floats = RHO) -> Floats:
    return -table_of(case, "pinion", flank).taken_off(case.pair, rho)


def test_the_own_pair_is_the_one_the_charts_are_made_for(tmp_path: Path) -> None:
    case = own_chart.case(tmp_path, chart({LEFT: TRACE}, diameter(RHO)))
    assert case.pair.pinion.base_radius == pytest.approx(BASE, rel=1e-14)
    assert (case.pair.path.a, case.pair.path.e) == pytest.approx((START, END), rel=1e-13)
    assert case.pair.pinion.tip_radius == pytest.approx(own_chart.TIP, rel=1e-14)


def test_slope_form_and_what_acts_are_read_back_of_60_random_traces(tmp_path: Path) -> None:
    """Bounds from the noise alone: five standard errors, and what the filter takes of a wave."""
    rng = np.random.default_rng(20131)
    drawn = []
    for _number in range(60):
        points, teeth = int(rng.integers(100, 500)), int(rng.integers(1, 5))
        noise = rng.uniform(0.0, 0.4)
        slope, form = rng.uniform(-10.0, 10.0), rng.uniform(0.5, 8.0)
        waves, phase = rng.uniform(1.0, 4.0), rng.uniform(0.0, 2.0 * math.pi)
        truth = WavyProfile(
            "pinion", slope=1e-6 * slope, form=1e-6 * form, waves=waves, phase=phase
        )
        scatter = rng.standard_normal((teeth, points))
        drawn.append((points, teeth, noise, slope, form, waves, truth, scatter))
    worst = np.zeros(3)
    for points, teeth, noise, slope, form, waves, truth, scatter in drawn:
        rho = np.linspace(START, END, points)
        clean = 1e6 * truth.added((rho - START) / (END - START))
        columns = {f"tooth {k + 1} left [um]": clean + noise * scatter[k] for k in range(teeth)}
        case = own_chart.case(tmp_path, chart(columns, diameter(rho)))
        flank = case.charts[0].flanks[0]
        step = (END - START) / (points - 1)
        shortest = max((END - START) / 30.0, 2.0 * step)
        left = noise * math.sqrt(1.508 * step / shortest)
        lost = form * (1.0 - 2.0 ** -((waves * shortest / (END - START)) ** 2))
        for figures in flank.figures:
            apart = 1e6 * figures.slope - slope
            # the ends of an even sampling count twice in the mean line: 3 form/places
            ends = 3.0 * form * shortest / (8.0 * (END - START))
            assert abs(apart) < 5.0 * noise * math.sqrt(12.0 / points) + 2.0 * lost + ends
            worst[0] = max(worst[0], abs(apart))
            apart = 1e6 * figures.form - form
            assert abs(apart) < 8.0 * left + 2.0 * lost + 0.02 * form
            worst[1] = max(worst[1], abs(apart))
        level = np.interp(own_chart.BASE * math.tan(math.radians(20.0)), rho, clean)
        rest = 1e6 * acts(case, rho=rho) - (clean - level)
        bound = 5.0 * noise / math.sqrt(teeth) * math.sqrt(1.508 * step / flank.cutoff)
        bound += 2.0 * form * (1.0 - 2.0 ** -((waves * flank.cutoff / (END - START)) ** 2)) + 0.05
        apart = float(np.std(rest))
        assert apart < bound
        worst[2] = max(worst[2], apart)
    print(
        f"60 traces, worst: f_Halpha {worst[0]:.3f}, f_falpha {worst[1]:.3f}, "
        f"acting {worst[2]:.3f} um"
    )


def test_roll_angle_roll_length_radius_and_diameter_are_one_trace(tmp_path: Path) -> None:
    forms = {
        "diameter [mm]": diameter(RHO),
        "diameter [in]": diameter(RHO) / 25.4,
        "radius [mm]": 0.5 * diameter(RHO),
        "roll angle [deg]": np.degrees(RHO / BASE),
        "roll angle [rad]": RHO / BASE,
        "roll length [mm]": 1e3 * RHO,
    }
    found = {
        over: own_chart.case(tmp_path, chart({LEFT: TRACE}, values, over))
        for over, values in forms.items()
    }
    first = found["diameter [mm]"]
    apart = {over: float(np.max(np.abs(acts(one) - acts(first)))) for over, one in found.items()}
    print("acting apart [m]:", apart)
    assert max(apart.values()) < 1e-9
    figures = np.array([one.charts[0].flanks[0].figures[0] for one in found.values()])
    assert np.ptp(figures, axis=0).max() < 1e-9


def test_decimal_commas_semicolons_quotes_marks_and_encodings_are_one_trace(tmp_path: Path) -> None:
    text = chart({LEFT: TRACE, RIGHT: -TRACE}, diameter(RHO), "diameter [mm]", "drive: left")
    plain = acts(own_chart.case(tmp_path, text))
    lines = text.splitlines()
    german = "\n".join(
        [lines[0], *(line.replace(",", ";").replace(".", ",") for line in lines[1:])]
    )
    tabs = "\r\n".join(line.replace(",", "\t") for line in lines)
    quoted = "\n".join(
        [lines[0], ",".join(f'"{cell}"' for cell in lines[1].split(",")), *lines[2:]]
    )
    for form in (german, tabs, quoted, "\ufeff" + text, text.replace("um", "µm")):
        assert np.array_equal(acts(own_chart.case(tmp_path, form)), plain)
    file = tmp_path / "pinion.csv"
    for encoding in ("utf-16", "latin-1"):
        file.write_bytes(text.replace("um", "µm").encode(encoding))
        again = load_case(tmp_path / "mine.toml")
        assert isinstance(again, GearCase)
        assert np.array_equal(acts(again), plain)
    back = chart({LEFT: TRACE[::-1]}, diameter(RHO)[::-1])
    assert np.array_equal(acts(own_chart.case(tmp_path, back)), plain)


def test_left_and_right_change_places_with_drive_and_back(tmp_path: Path) -> None:
    both = {LEFT: TRACE, RIGHT: 0.5 * TRACE + SHARE**2}
    left = own_chart.case(tmp_path, chart(both, diameter(RHO), "diameter [mm]", "drive: left"))
    right = own_chart.case(tmp_path, chart(both, diameter(RHO), "diameter [mm]", "drive: right"))
    named = {"tooth 1 drive [um]": TRACE, "tooth 1 back [um]": both[RIGHT]}
    said = own_chart.case(tmp_path, chart(named, diameter(RHO)))
    for one, other in (("drive", "back"), ("back", "drive")):
        assert np.array_equal(acts(left, one), acts(right, other))
        assert np.array_equal(acts(left, one), acts(said, one))
    assert not np.array_equal(acts(left, "drive"), acts(left, "back"))


def test_the_sign_turns_the_flank(tmp_path: Path) -> None:
    text = chart({LEFT: TRACE}, diameter(RHO))
    plain = acts(own_chart.case(tmp_path, text))
    inside = acts(own_chart.case(tmp_path, "# sign: material inside is positive\n" + text))
    outside = acts(own_chart.case(tmp_path, "# sign: material outside is positive\n" + text))
    assert np.array_equal(inside, -plain)
    assert np.array_equal(outside, plain)
    # more material at the tip is a positive slope
    assert plain[-1] > plain[0]


def test_the_mean_of_n_teeth_acts_with_the_noise_of_one_over_root_n(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    left = {}
    for teeth in (1, 4, 16):
        rest = []
        for _number in range(16):
            noise = 0.01 * rng.standard_normal((teeth, RHO.size))
            columns = {f"tooth {k + 1} left [um]": noise[k] for k in range(teeth)}
            flank = own_chart.case(tmp_path, chart(columns, diameter(RHO))).charts[0].flanks[0]
            # a median of n absolute rests errs by 1.17/sqrt(n); neighbours share points: twice
            # the variance is allowed, four standard errors
            assert flank.noise == pytest.approx(
                0.01e-6, rel=min(0.3, 4.0 * 1.17 * math.sqrt(2.0 / (teeth * RHO.size)))
            )
            # so quiet that the standard's cut-off stands: the teeth alone make the difference
            assert flank.cutoff == pytest.approx((END - START) / 30.0, rel=1e-9)
            rest.append(float(np.var(flank.acting)))
        left[teeth] = math.sqrt(np.mean(rest))
    print("noise that acts [nm]:", {k: round(1e9 * v, 2) for k, v in left.items()})
    assert left[4] == pytest.approx(left[1] / 2.0, rel=0.12)
    assert left[16] == pytest.approx(left[1] / 4.0, rel=0.12)


def test_noise_makes_no_bump_that_could_carry(tmp_path: Path) -> None:
    """Rms curvature of the smoothed noise over the least curvature of the flanks: a quarter."""
    rng = np.random.default_rng(9)
    ratios = []
    for _number in range(20):
        noise = 0.15 * rng.standard_normal(RHO.size)
        case = own_chart.case(tmp_path, chart({LEFT: noise}, diameter(RHO)))
        flank = case.charts[0].flanks[0]
        assert not flank.limited
        step = flank.rho[1] - flank.rho[0]
        bend = np.diff(flank.acting, 2) / step**2
        one, length = flank.rho[1:-1], case.pair.line_of_action
        own = (one / BASE) ** 2 / (one * (length - one) / length)
        ratios.append(np.std(bend[4:-4]) / own.min())
    print(f"noise's curvature over the flanks': {np.mean(ratios):.3f}, worst {max(ratios):.3f}")
    assert np.mean(ratios) < 0.25
    noise = 3.0 * rng.standard_normal(RHO.size)
    assert own_chart.case(tmp_path, chart({LEFT: noise}, diameter(RHO))).charts[0].flanks[0].limited


def test_beyond_the_evaluated_range_the_flank_stays_as_it_ends(tmp_path: Path) -> None:
    low, high = 58.0, 65.0
    lines = (f"evaluate: {low}..{high} mm",)
    case = own_chart.case(tmp_path, chart({LEFT: TRACE}, diameter(RHO), "diameter [mm]", *lines))
    flank = case.charts[0].flanks[0]
    assert diameter(flank.rho[[0, -1]]) == pytest.approx((low, high), abs=0.05)
    ends = acts(case, rho=np.array([0.5 * START, flank.rho[0], flank.rho[-1], 1.2 * END]))
    assert ends[0] == pytest.approx(ends[1], abs=1e-15)
    assert ends[2] == pytest.approx(ends[3], abs=1e-15)
    # figures of that range alone
    inside = (flank.rho[0] <= RHO) & (flank.rho[-1] >= RHO)
    plain = profile_figures(RHO[inside], added=1e-6 * TRACE[inside])
    assert flank.figures[0].slope == pytest.approx(plain.slope, abs=0.1e-6)
    for other in ("evaluate: roll angle 13.8..33.1 deg", "evaluate: 58,0 mm .. 65,0 mm"):
        again = own_chart.case(
            tmp_path, chart({LEFT: TRACE}, diameter(RHO), "diameter [mm]", other)
        )
        assert again.charts[0].flanks[0].rho[0] == pytest.approx(flank.rho[0], rel=0.05)


def test_zeros_change_no_bit(tmp_path: Path) -> None:
    zero = {LEFT: 0.0 * SHARE, RIGHT: 0.0 * SHARE}
    text = chart(zero, diameter(RHO), "diameter [mm]", "drive: left")
    more = "[transmission_error]\nharmonics = []\n"
    measured = own_chart.case(tmp_path, text, "", more)
    plain = load_case(own_chart.CASE + more)
    assert isinstance(plain, GearCase)
    assert len(measured.deviations) == 2 + len(plain.deviations) + 2  # the wheel is graded
    measured = own_chart.case(tmp_path, text, _wheel(), more)
    assert all(isinstance(one, FlankTable) for one in measured.deviations)
    model = plain.models[0]
    one, two = (case.cycle(case.operating, model) for case in (plain, measured))
    assert set(one.variables) == set(two.variables)
    for name in one.variables:
        np.testing.assert_array_equal(one[name].values, two[name].values, err_msg=str(name))


def _wheel() -> str:
    columns = {LEFT: np.zeros(60), RIGHT: np.zeros(60)}
    return chart(columns, np.linspace(117.5, 125.9, 60), "diameter [mm]", "drive: right")


def test_a_chart_replaces_the_class_of_its_gear_alone(tmp_path: Path) -> None:
    case = own_chart.case(tmp_path, chart({LEFT: TRACE}, diameter(RHO)))
    kinds = [(type(one).__name__, one.gear) for one in case.deviations]  # type: ignore[attr-defined]
    assert kinds == [("FlankTable", "pinion"), *[("WavyProfile", "wheel")] * 2]
    assert case.accuracy == 6
    told = {one.field: one.value for one in case.assumptions}
    assert told["flanks.accuracy"] == "6, wheel"
    assert case.measured_class == case.charts[0].flanks[0].grades[0]
    both = own_chart.case(tmp_path, chart({LEFT: TRACE}, diameter(RHO)), _wheel())
    assert both.accuracy is None
    assert both.measured_class == case.measured_class
    told = {one.field: one.value for one in both.assumptions}
    assert told["flanks.accuracy"] == told["flanks.seed"]
    assert told["flanks.seed"].startswith("none:")


def test_the_text_of_the_case_needs_the_file_no_more(tmp_path: Path) -> None:
    case = own_chart.case(tmp_path, chart({LEFT: TRACE}, diameter(RHO)))
    (tmp_path / "pinion.csv").unlink()
    again = load_case(case.text)
    assert isinstance(again, GearCase)
    assert again.text == case.text
    assert np.array_equal(acts(again), acts(case))
    turned = load_case(case.text, ["operating.speed=2000 rpm"])
    assert isinstance(turned, GearCase)
    assert np.array_equal(acts(turned), acts(case))


def test_another_flank_file_is_another_case(tmp_path: Path) -> None:
    """What long work is found again by changes with the file, and not with its name."""
    first = own_chart.case(tmp_path, chart({LEFT: TRACE}, diameter(RHO)))
    second = own_chart.case(tmp_path, chart({LEFT: 1.001 * TRACE}, diameter(RHO)))
    one, two = (
        family(case, ("pinion_speed",), case.models[0].name, "undeformed").inputs()
        for case in (first, second)
    )
    assert one["case"] != two["case"]
    third = own_chart.case(tmp_path, chart({LEFT: TRACE}, diameter(RHO)))
    assert third.text == first.text


@pytest.mark.parametrize("gear", ["pinion", "wheel"])
def test_pitch_deviations_act_as_those_of_a_case_along_the_arc(tmp_path: Path, gear: str) -> None:
    """Single pitches, or their sums from any tooth on, are the case's single pitches."""
    teeth = {"pinion": 20, "wheel": 40}[gear]
    single = np.random.default_rng(1).normal(0.0, 3.0, teeth)
    single -= single.mean()
    stated = str([f"{value!r} um" for value in single.tolist()])
    kinds = ["gears.pitch_errors_are=single pitch", "gears.pitch_errors_along=arc"]
    expected = load_case(own_chart.CASE, [f"gears.{gear}.pitch_errors={stated}", *kinds])
    assert isinstance(expected, GearCase)
    wanted = next(one for one in expected.deviations if isinstance(one, PitchError))
    traces = chart({LEFT: TRACE}, diameter(RHO)), _wheel()
    for name, values in {
        "single pitch left": single,
        "cumulative pitch drive": np.cumsum(single) + 7.0,
        "cumulative pitch": np.cumsum(single),
    }.items():
        rows = "\n".join(f"{k + 1},{value!r}" for k, value in enumerate(values.tolist()))
        block = f"\ntooth,{name} [um]\n{rows}\n"
        texts = [text + block * (each == gear) for each, text in zip(GEARS, traces, strict=True)]
        case = own_chart.case(tmp_path, *texts)
        (error,) = (one for one in case.deviations if isinstance(one, PitchError))
        assert error.gear == gear
        np.testing.assert_allclose(error.errors, wanted.errors, atol=1e-15)
        assert case.period == Period(teeth, (20, 40))
    with pytest.raises(InputError) as caught:
        load_case(tmp_path / "mine.toml", [f"gears.{gear}.pitch_errors={stated}"])
    assert str(caught.value) == (
        f"gears.{gear}.pitch_errors: got given beside {gear}.csv; the chart's column 'cumulative "
        "pitch' says where the teeth are; leave one out"
    )


def test_a_chart_beside_profiles_of_the_same_teeth_is_refused(tmp_path: Path) -> None:
    own_chart.case(tmp_path, chart({LEFT: TRACE}, diameter(RHO)))
    with pytest.raises(InputError) as caught:
        load_case(tmp_path / "mine.toml", ["gears.pinion.tooth_profiles=[{slope='1 um'}]"])
    assert str(caught.value) == (
        "flanks.pinion: got pinion.csv; [gears.pinion.tooth_profiles] gives the same flanks; leave "
        "one out"
    )


def test_single_pitches_of_a_chart_that_do_not_close_are_refused(tmp_path: Path) -> None:
    rows = "".join(f"{k + 1},1\n" for k in range(20))
    text = chart({LEFT: TRACE}, diameter(RHO)) + f"\ntooth,single pitch left [um]\n{rows}"
    with pytest.raises(InputError) as caught:
        own_chart.case(tmp_path, text)
    assert str(caught.value) == (
        "flanks.pinion: got single pitch deviations that add up to 20 um; allowed -10..10 um; "
        "after a whole turn the pitches close; are they positions of the teeth? then name the "
        "column 'cumulative pitch left'"
    )


def test_pitch_deviations_are_kept(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    pitch = rng.normal(0.0, 3.0, 20)
    pitch -= pitch.mean()
    rows = "\n".join(f"{k + 1},{value:.3f}" for k, value in enumerate(pitch))
    block = f"\ntooth,single pitch left [um]\n{rows}\n"
    text = chart({LEFT: TRACE}, diameter(RHO))
    case = own_chart.case(tmp_path, text + block)
    kept = case.charts[0].read.pitch["single pitch left"]
    np.testing.assert_allclose(kept, 1e-6 * pitch, atol=1e-9)
    assert np.array_equal(acts(case), acts(own_chart.case(tmp_path, text)))
    (tmp_path / "pitch.csv").write_text(block.lstrip(), encoding="utf-8")
    own_chart.case(tmp_path, text)
    file = tmp_path / "mine.toml"
    names = file.read_text().replace('"pinion.csv"', '["pinion.csv", "pitch.csv"]')
    file.write_text(names)
    second = load_case(file)
    assert isinstance(second, GearCase)
    np.testing.assert_array_equal(second.charts[0].read.pitch["single pitch left"], kept)


GOOD = chart({LEFT: TRACE}, diameter(RHO))
ROWS = GOOD.splitlines()


def _with(place: int, row: str) -> str:
    return "\n".join([*ROWS[:place], row, *ROWS[place + 1 :]]) + "\n"


BAD: list[tuple[str, str, str]] = [
    ("empty", "", "it is empty"),
    ("text", "Dear Sir,\nplease find the chart enclosed.\n", "column 'dear sir'"),
    ("words alone", "some words\n", "column 'some words'; allowed diameter | radius"),
    ("numbers alone", "\n".join(ROWS[1:]), "allowed a header above the numbers"),
    ("one row", "\n".join(ROWS[:2]), "1 row of numbers"),
    ("no row", ROWS[0] + "\n", "no rows of numbers"),
    (
        "few rows",
        "\n".join([ROWS[0], *ROWS[1::40]]),
        "7 points of the trace in the evaluated range",
    ),
    ("unordered", "\n".join([*ROWS[:5], ROWS[6], ROWS[5], *ROWS[7:]]), "line 7: diameter"),
    ("twice", "\n".join([*ROWS[:6], ROWS[5], *ROWS[6:]]), "twice; allowed points in order"),
    ("nan", _with(9, "57.0,nan"), "line 10: 'nan' in column 'tooth 1 left [um]'; allowed a number"),
    ("gap", _with(9, "57.0,"), "1 values; allowed 2"),
    ("inf", _with(9, "57.0,1e999"), "line 10: a number beyond reason"),
    ("word", _with(9, "57.0,high"), "line 10: 'high' in column"),
    (
        "below the base",
        _with(1, "56.2,0"),
        "line 2: diameter 56.2 mm; allowed diameters 56.3816..66 mm",
    ),
    ("above the tip", "\n".join([*ROWS, "66.4,0"]), "it lies above the tip of the pinion"),
    ("the wheel's", _wheel(), "above the tip of the pinion"),
    ("no unit", GOOD.replace(" [um]", ""), "are the values, up to 4.43657, micrometres?"),
    ("no unit of the position", GOOD.replace(" [mm]", ""), "column 'diameter' without a unit"),
    ("odd unit", GOOD.replace("[um]", "[ticks]"), "allowed a unit of length"),
    ("degrees", GOOD.replace("[um]", "[deg]"), "allowed a unit of length"),
    ("wrong unit", GOOD.replace("[um]", "[mm]"), "allowed -2000..2000 um; correct the unit"),
    ("no side", GOOD.replace("tooth 1 left", "tooth 1"), "which flank is it?"),
    ("which drives", chart({LEFT: TRACE, RIGHT: TRACE}, diameter(RHO)), "which of them drives?"),
    ("odd drive", "# drive: clockwise\n" + GOOD, "allowed left | right"),
    (
        "odd sign",
        "# sign: minus\n" + GOOD,
        "allowed material outside is positive | material inside",
    ),
    (
        "two signs",
        "# sign: outside is positive\n# sign: inside is positive\n" + GOOD,
        "leave one out",
    ),
    ("misspelt", "# evalute: 58..65 mm\n" + GOOD, "did you mean 'evaluate'?"),
    ("range without unit", "# evaluate: 58..65\n" + GOOD, "its unit is missing"),
    ("odd range", "# evaluate: all of it\n" + GOOD, "for instance '# evaluate: 62.1..66.8 mm'"),
    ("turned range", "# evaluate: 65..58 mm\n" + GOOD, "a lower and a higher end"),
    (
        "range elsewhere",
        "# evaluate: 65.98..65.99 mm\n" + GOOD,
        "points of the trace in the evaluated",
    ),
    ("tooth 21", GOOD.replace("tooth 1", "tooth 21"), "tooth 21; allowed 1..20"),
    ("teeth", "# teeth: 22\n" + GOOD, "22 teeth (# teeth); allowed 20"),
    (
        "pitch of 19",
        GOOD + "tooth,single pitch left [um]\n" + "\n".join(f"{k},1" for k in range(1, 20)),
        "19 teeth",
    ),
    (
        "one tooth twice",
        chart({LEFT: TRACE, LEFT + " ": TRACE}, diameter(RHO)),
        "tooth 1 left twice",
    ),
    ("two tables", GOOD + GOOD, "2 tables of profile traces"),
    ("decimal commas", GOOD.replace(".", ","), "values; allowed 2, one for each column"),
    ("a million rows", ROWS[0] + "\n" + "57.1,0.1\n" * 1_000_000, "at most 400000 characters"),
    ("binary", GOOD + "\x00", "it holds binary data"),
]


@pytest.mark.parametrize(("text", "words"), [b[1:] for b in BAD], ids=[b[0] for b in BAD])
def test_a_hostile_file_is_one_line(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(InputError) as told:
        own_chart.case(tmp_path, text)
    message = str(told.value)
    assert message.startswith("flanks.pinion: got ")
    assert words in message
    assert "\n" not in message
    assert told.value.line is not None


@pytest.mark.parametrize(
    ("name", "words"),
    [("", "it is a directory"), ("nothing.csv", "there is no such file in")],
)
def test_no_file_is_told(tmp_path: Path, name: str, words: str) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(f'{own_chart.CASE}\n[flanks]\npinion = "{name}"\n')
    with pytest.raises(InputError, match=words):
        load_case(file)


def test_the_chart_of_the_how_to_is_read(tmp_path: Path) -> None:
    page = Path(__file__).parents[2] / "docs" / "howto" / "measured_flanks.md"
    text = page.read_text(encoding="utf-8").split("```text\n")[1].split("```")[0]
    case = own_chart.case(tmp_path, text)
    drive, back = case.charts[0].flanks
    assert (drive.flank, back.flank) == ("drive", "back")
    assert case.charts[0].hand(1) == "tooth 1 right (drive)"
    assert drive.figures[0].slope > 4e-6
    assert case.charts[0].read.signed


@pytest.mark.parametrize(
    ("over", "places", "module", "most"),
    [
        ("diameter [in]", diameter(RHO) / 25.4, 3.0 / 25.4, 5),
        ("roll angle [deg]", np.degrees(RHO / BASE), math.degrees(3e-3 / BASE), 4),
        ("roll length [mm]", 1e3 * RHO, 3.0, 4),
    ],
    ids=["in", "deg", "mm"],
)
def test_an_end_that_misses_the_tip_by_the_rounding_of_its_digits_is_taken(
    tmp_path: Path, over: str, places: Floats, module: float, most: int
) -> None:
    """Half a unit of the last digit, never more than a hundredth of a module."""
    taken = refused = 0
    for digits in range(1, most + 1):
        unit = 10.0**-digits
        inner = [f"{d:.{digits}f}" for d in np.linspace(places[60], places[-1] - 2.0 * unit, 13)]
        nearest = round(float(places[-1]) / unit) * unit
        for last in (nearest, nearest + unit):
            rows = [f"{d},0" for d in dict.fromkeys([*inner, f"{last:.{digits}f}"])]
            beyond = float(f"{last:.{digits}f}") - float(places[-1])
            text = "\n".join([f"{over}, {LEFT}", *rows]) + "\n"
            if beyond > min(0.5 * unit, 0.01 * module):
                with pytest.raises(InputError, match="it lies above the tip of the pinion"):
                    own_chart.case(tmp_path, text)
                refused += 1
            elif beyond > 0.0 and len(rows) > 10:
                found = own_chart.case(tmp_path, text).charts[0].traces.rho[-1]
                assert found == pytest.approx(END, rel=1e-12)
                taken += 1
    assert taken >= 1
    assert refused >= 4
