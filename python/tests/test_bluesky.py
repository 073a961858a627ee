"""The plugin in BlueSky itself, headless: conflicts of BlueSky's own generator, with MVP and with fga.

FGA_BLUESKY names more scenarios, one a line: commands of the generator, or scenario files.
"""

import os

import pytest
from conftest import needed

needed("bluesky")
import bluesky_flights  # noqa: E402

SCENARIOS = [("SYN SIMPLE", 600.0), ("SYN SUPER 4", 700.0)]
SCENARIOS += [(line, 1200.0) for line in os.environ.get("FGA_BLUESKY", "").splitlines() if line]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return str(tmp_path_factory.mktemp("bluesky"))


@pytest.mark.parametrize(("scenario", "for_s"), SCENARIOS)
def test_no_separation_is_lost_that_mvp_keeps(folder, scenario, for_s):
    flown = {method: bluesky_flights.flown_apart(folder, scenario, method, for_s) for method in ("OFF", "MVP", "FGA")}
    for method, told in flown.items():
        assert told["simulated_s"] >= for_s - 1.0, f"{method} runs to the end"
    assert flown["OFF"]["lost"], "they would lose separation"
    mvp, fga = (
        {frozenset(pair) for pair in flown[method]["lost"]} for method in ("MVP", "FGA")
    )
    assert fga <= mvp
    if scenario == "SYN SIMPLE":
        # Without right of way both flew away side by side.
        away = bluesky_flights.departures_m(flown["FGA"]["tracks"], flown["OFF"]["tracks"])
        assert min(away.values()) < 100.0, "one has the right of way"
        assert max(away.values()) < 15 * bluesky_flights.NAUTICAL_MILE_M


# Two that cross while both climb, as the autopilot of each goes on doing.
CLIMBING = """
00:00:00.00>CRE NORTH B744 0.0 0.0 0 FL100 350
00:00:00.00>CRE WEST B744 1.0 0.985 270 FL100 350
00:01:00.00>ALT NORTH FL300
00:01:00.00>ALT WEST FL300
"""


def test_no_manoeuvre_of_a_climbing_aircraft_rests_on_levelling_off(folder, tmp_path):
    # An earlier version planned to pass below by levelling off, which nobody commanded, turned late, and both flew far off.
    scenario = tmp_path / "climbing.scn"
    scenario.write_text(CLIMBING)
    flown = {method: bluesky_flights.flown_apart(folder, str(scenario), method, 900.0) for method in ("OFF", "FGA")}
    assert flown["OFF"]["lost"], "they would lose separation"
    assert not flown["FGA"]["lost"]
    away = bluesky_flights.departures_m(flown["FGA"]["tracks"], flown["OFF"]["tracks"])
    assert min(away.values()) < 100.0, "one has the right of way"
    assert max(away.values()) < 12 * bluesky_flights.NAUTICAL_MILE_M, away


# Far above their ceiling: they sink, away from the altitude that is selected.
SINKING = """
00:00:00.00>CRE NORTH B744 -0.9 0.0 0 65617 110
00:00:00.00>CRE EAST B744 0.45 -0.7794 120 65617 110
00:00:00.00>CRE WEST B744 0.45 0.7794 240 65617 110
"""


def test_aircraft_that_sink_from_above_their_ceiling_are_expected_to_sink_on(folder, tmp_path):
    # An earlier version expected them back at the altitude that was selected, and met at a fifth of the zone's height.
    scenario = tmp_path / "sinking.scn"
    scenario.write_text(SINKING)
    flown = {method: bluesky_flights.flown_apart(folder, str(scenario), method, 700.0) for method in ("OFF", "FGA")}
    assert flown["OFF"]["lost"], "they would lose separation"
    assert not flown["FGA"]["lost"]


# One is to level off below the other, and is cleared to climb through its altitude 150 s before they meet.
CLEARED = """
00:00:00.00>CRE NORTH B744 0.0 0.0 0 FL100 350
00:00:00.00>CRE WEST B744 0.95 1.055 270 FL220 350
00:00:01.00>RESOOFF WEST
00:00:01.00>ALT NORTH FL200
00:05:30.00>ALT NORTH FL300
"""


def test_an_aircraft_that_is_cleared_higher_in_a_conflict_is_expected_there(folder, tmp_path):
    # An earlier version kept the altitude that was selected when BlueSky found the conflict.
    scenario = tmp_path / "cleared.scn"
    scenario.write_text(CLEARED)
    flown = {method: bluesky_flights.flown_apart(folder, str(scenario), method, 700.0) for method in ("OFF", "FGA")}
    assert flown["OFF"]["lost"], "they would lose separation"
    assert not flown["FGA"]["lost"]


def row_of(apart_in_zones):
    """Seven abreast, and one that meets the middle one head-on: by the names, the row would give way."""
    apart_deg = apart_in_zones * bluesky_flights.ZONE_M / 111_319.0
    lines = ["CRE LONE B744 0.01 -0.45 90 20000 0.63"]
    lines += [f"CRE ROW{k} B744 {(k - 3) * apart_deg:.6f} 0.45 270 20000 0.63" for k in range(7)]
    return "".join(f"00:00:00.00>{line}\n" for line in lines)


@pytest.mark.parametrize("apart_in_zones", [1.1, 1.008])
def test_whoever_has_room_gives_way(folder, tmp_path, apart_in_zones):
    # An earlier version asked the middle one of the row to give way, which has no room: it pushed its neighbours into each other. At
    # 1.008 zones they fly within RFACH times the zone of each other.
    scenario = tmp_path / "row.scn"
    scenario.write_text(row_of(apart_in_zones))
    flown = {method: bluesky_flights.flown_apart(folder, str(scenario), method, 450.0) for method in ("OFF", "FGA")}
    assert flown["OFF"]["lost"], "they would lose separation"
    assert not flown["FGA"]["lost"]


def test_a_neighbour_inside_of_the_enlarged_zone_keeps_its_distance():
    import numpy as np

    from fga.bluesky import _zones

    # Side by side, above, within the zone itself, and far.
    beside_m, above_m = np.array([9_300.0, 0.0, 5_000.0, 20_000.0]), np.array([0.0, 310.0, 100.0, 0.0])
    radius_m, half_height_m = _zones((beside_m, above_m), (np.full(4, 9_260.0), np.full(4, 304.8)), (1.05, 1.05))
    assert list(radius_m) == pytest.approx([9_260.0, 9_723.0, 9_723.0, 9_723.0])
    assert list(half_height_m) == pytest.approx([320.04, 308.45, 320.04, 320.04])


def test_the_plugin_is_installed_by_a_command(tmp_path, capsys):
    from fga import bluesky

    assert bluesky.main([str(tmp_path)]) == 0
    path = tmp_path / "plugins" / "fga.py"
    # BlueSky prints what it loads before.
    assert capsys.readouterr().out.splitlines()[-1] == str(path)
    compile(path.read_text(), str(path), "exec")
    assert bluesky.main([]) == 1
    assert "usage" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("bearings", "gives_way"),
    [
        # East of a northbound aircraft, westbound: the northbound one has it on its right.
        (((0.0, 0.0, 0.0), (0.1, 0.1, 270.0)), True),
        (((0.1, 0.1, 270.0), (0.0, 0.0, 0.0)), False),
        # Overtaking: behind on the same track.
        (((0.0, 0.0, 0.0), (0.1, 0.0, 5.0)), True),
        (((0.1, 0.0, 0.0), (0.0, 0.0, 355.0)), False),
    ],
)
def test_right_of_way_is_that_of_the_rules_of_the_air(bearings, gives_way):
    from types import SimpleNamespace

    from fga.bluesky import _gives_way

    lat, lon, trk = zip(*bearings)
    traffic = SimpleNamespace(lat=lat, lon=lon, trk=trk, id=["A", "B"])
    assert _gives_way(traffic, 0, 1) is gives_way
    assert _gives_way(traffic, 1, 0) is not gives_way


def test_a_pair_dead_ahead_has_one_that_gives_way():
    from types import SimpleNamespace

    from fga.bluesky import _gives_way

    traffic = SimpleNamespace(lat=(0.0, 0.5), lon=(0.0, 0.0), trk=(0.0, 180.0), id=["A", "B"])
    assert _gives_way(traffic, 0, 1) != _gives_way(traffic, 1, 0)
