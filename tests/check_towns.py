"""Checks OpenDRIVE files from outside: with a small reader of its own, and with the ASAM quality checker.

Usage: python3 check_towns.py FILE_OR_FOLDER ...

The reader here (standard library only) walks every reference line by Simpson's rule and compares, at every link, where
the two lanes that are said to touch really are. The ASAM checker is `pip install asam-qc-opendrive`. Exit code 1 when
either finds an error, 77 when the ASAM checker is missing and the rest is fine.
"""

import importlib.util
import math
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET

GAP_M = 0.02
KINK_RAD = 1e-3


def numbers(element, *names):
    return [float(element.get(name)) for name in names]


def cubic(records, s):
    """Value of the last record that begins at or before s; records are (start, a, b, c, d)."""
    value = 0.0
    for start, a, b, c, d in records:
        if start > s + 1e-9 and records[0][0] != start:
            break
        ds = max(s - start, 0.0)
        value = a + ds * (b + ds * (c + ds * d))
    return value


class Piece:
    """A piece of a reference line."""

    def __init__(self, element):
        self.s, self.x, self.y, self.hdg, self.length = numbers(element, "s", "x", "y", "hdg", "length")
        shape = element[0]
        self.k0 = self.k1 = 0.0
        if shape.tag == "arc":
            self.k0 = self.k1 = float(shape.get("curvature"))
        elif shape.tag == "spiral":
            self.k0, self.k1 = numbers(shape, "curvStart", "curvEnd")
        elif shape.tag != "line":
            raise ValueError(f"{shape.tag} is not expected in a generated town")

    def at(self, ds):
        """Position and heading after ds metres."""
        rate = (self.k1 - self.k0) / self.length if self.length > 0 else 0.0
        heading = lambda u: self.hdg + u * (self.k0 + 0.5 * rate * u)
        panels = 2 * max(8, math.ceil(abs(heading(ds) - self.hdg) * 20 + ds / 5))
        h = ds / panels
        x = y = 0.0
        for i in range(panels + 1):
            weight = 1 if i in (0, panels) else 4 if i % 2 else 2
            x += weight * math.cos(heading(i * h))
            y += weight * math.sin(heading(i * h))
        return self.x + x * h / 3, self.y + y * h / 3, heading(ds)


class Road:
    """What of a road is needed to find its lanes."""

    def __init__(self, element):
        self.id, self.length = element.get("id"), float(element.get("length"))
        self.junction = element.get("junction")
        self.pieces = [Piece(g) for g in element.find("planView")]
        records = lambda path, start="s": [
            tuple(numbers(r, start, "a", "b", "c", "d")) for r in element.findall(path)
        ]
        self.elevation = records("elevationProfile/elevation")
        self.superelevation = records("lateralProfile/superelevation")
        self.offset = records("lanes/laneOffset")
        self.sections = []
        for section in element.findall("lanes/laneSection"):
            lanes = {}
            for lane in section.findall("left/lane") + section.findall("right/lane"):
                widths = [tuple(numbers(w, "sOffset", "a", "b", "c", "d")) for w in lane.findall("width")]
                ends = {tag: [int(e.get("id")) for e in lane.findall(f"link/{tag}")] for tag in ("predecessor", "successor")}
                lanes[int(lane.get("id"))] = (widths, ends, lane.get("type"))
            self.sections.append((float(section.get("s")), lanes))
        self.links = {tag: element.find(f"link/{tag}") for tag in ("predecessor", "successor")}

    def lane_middle(self, end, lane):
        """Middle and width of a lane at the road's "start" or "end"."""
        start, lanes = self.sections[0 if end == "start" else -1]
        s = 0.0 if end == "start" else self.length
        piece = self.pieces[0 if end == "start" else -1]
        x, y, heading = piece.at(s - piece.s)
        t = cubic(self.offset, s)
        sign = 1 if lane > 0 else -1
        width = 0.0
        for i in range(sign, lane + sign, sign):
            t += sign * width
            width = cubic(lanes[i][0], s - start)
        t += sign * 0.5 * width
        roll = cubic(self.superelevation, s)
        z = cubic(self.elevation, s) + t * math.sin(roll)
        t *= math.cos(roll)
        return (x - t * math.sin(heading), y + t * math.cos(heading), z), width


def own_faults(path):
    root = ET.parse(path).getroot()
    roads = {}
    for element in root.findall("road"):
        road = Road(element)
        if road.id in roads:
            yield f"two roads are called {road.id}"
        roads[road.id] = road
    junctions = {j.get("id"): j for j in root.findall("junction")}
    signals = [s.get("id") for s in root.iter("signal")]
    if len(set(signals)) != len(signals):
        yield "signal ids repeat"
    if not roads:
        yield "there are no roads"
    for road in roads.values():
        for a, b in zip(road.pieces, road.pieces[1:]):
            x, y, heading = a.at(a.length)
            if math.hypot(x - b.x, y - b.y) > GAP_M or abs(math.remainder(heading - b.hdg, math.tau)) > KINK_RAD:
                yield f"road {road.id}: the reference line breaks at s = {b.s}"
        if abs(sum(p.length for p in road.pieces) - road.length) > 1e-3:
            yield f"road {road.id}: its pieces are not as long as the road"
        for i, (start, lanes) in enumerate(road.sections):
            end = road.sections[i + 1][0] if i + 1 < len(road.sections) else road.length
            for lane, (widths, _, _) in lanes.items():
                steps = [start + (end - start) * k / 20 for k in range(21)]
                if min(cubic(widths, s - start) for s in steps) < -1e-6:
                    yield f"road {road.id}: lane {lane} has a negative width"
        yield from link_faults(road, roads, junctions)
    for junction in junctions.values():
        for connection in junction.findall("connection"):
            yield from connection_faults(junction.get("id"), connection, roads)
    controlled = {c.get("signalId") for c in root.iter("control")}
    for unknown in controlled - set(signals):
        yield f"a controller names signal {unknown}, which there is not"
    for reference in root.iter("signalReference"):
        if reference.get("id") not in signals:
            yield f"a reference names signal {reference.get('id')}, which there is not"


def touching(what, a, end_a, lane_a, b, end_b, lane_b):
    """Says where two lanes that should touch do not."""
    if lane_b not in b.sections[0 if end_b == "start" else -1][1]:
        yield f"{what}: road {b.id} has no lane {lane_b} at its {end_b}"
        return
    (p, width_p), (q, width_q) = a.lane_middle(end_a, lane_a), b.lane_middle(end_b, lane_b)
    gap = math.dist(p, q)
    if gap > GAP_M or abs(width_p - width_q) > 2 * GAP_M:
        yield (
            f"{what}: lane {lane_a} at the {end_a} of road {a.id} and lane {lane_b} of road {b.id} are {gap:.3f} m "
            f"apart, {width_p:.2f} and {width_q:.2f} m wide"
        )


def link_faults(road, roads, junctions):
    for tag, end in (("predecessor", "start"), ("successor", "end")):
        link = road.links[tag]
        if link is None:
            continue
        to = link.get("elementId")
        if link.get("elementType") == "junction":
            if to not in junctions:
                yield f"road {road.id}: its {tag} is junction {to}, which there is not"
            continue
        if to not in roads:
            yield f"road {road.id}: its {tag} is road {to}, which there is not"
            continue
        lanes = road.sections[0 if end == "start" else -1][1]
        for lane, (_, ends, _) in lanes.items():
            for other in ends[tag]:
                yield from touching(f"{tag} of road {road.id}", road, end, lane, roads[to], link.get("contactPoint"), other)


def connection_faults(junction, connection, roads):
    incoming, through = roads.get(connection.get("incomingRoad")), roads.get(connection.get("connectingRoad"))
    what = f"junction {junction}, connection {connection.get('id')}"
    if incoming is None or through is None:
        yield f"{what}: it names a road that there is not"
        return
    ends = []
    for tag, end in (("predecessor", "start"), ("successor", "end")):
        link = incoming.links[tag]
        if link is not None and link.get("elementType") == "junction" and link.get("elementId") == junction:
            ends.append(end)
    if not ends:
        yield f"{what}: road {incoming.id} does not lead to this junction"
    for link in connection.findall("laneLink"):
        args = (through, connection.get("contactPoint"), int(link.get("to")))
        # A road may begin and end at one junction: one of its ends must touch.
        faults = [list(touching(what, incoming, end, int(link.get("from")), *args)) for end in ends]
        if faults and all(faults):
            yield from faults[0]


CONFIG = """<?xml version="1.0" encoding="UTF-8"?>
<Config>
  <Param name="InputFile" value="{file}"/>
  <CheckerBundle application="xodrBundle"><Param name="resultFile" value="{result}"/></CheckerBundle>
</Config>
"""


def asam_faults(path):
    """Issues of level ERROR, and checkers that broke down."""
    with tempfile.TemporaryDirectory() as folder:
        config, result = pathlib.Path(folder, "config.xml"), pathlib.Path(folder, "result.xqar")
        config.write_text(CONFIG.format(file=path.resolve(), result=result), encoding="utf-8")
        run = subprocess.run([sys.executable, "-m", "qc_opendrive.main", "-c", config], capture_output=True, text=True)
        if run.returncode != 0 or not result.exists():
            yield f"the ASAM checker failed: {run.stderr.strip().splitlines()[-1:]}"
            return
        for checker in ET.parse(result).getroot().iter("Checker"):
            name = checker.get("checkerId").removeprefix("check_asam_xodr_")
            if checker.get("status") not in ("completed", "skipped"):
                yield f"ASAM {name}: {checker.get('status')}: {checker.get('summary')}"
            for issue in checker.iter("Issue"):
                if issue.get("level") == "1":
                    places = [e.get("xpath") or e.get("description") or "" for e in issue.iter() if e is not issue]
                    yield f"ASAM {name}: {issue.get('description')} {' '.join(filter(None, places))[:300]}"


def main(arguments):
    paths = [pathlib.Path(a) for a in arguments]
    files = sorted(f for p in paths for f in ([p] if p.is_file() else p.rglob("*.xodr")))
    if not files:
        print("no .xodr file to check")
        return 2
    asam = importlib.util.find_spec("qc_opendrive") is not None
    bad = 0
    for file in files:
        faults = list(own_faults(file)) + (list(asam_faults(file)) if asam else [])
        bad += bool(faults)
        print(f"{file}: {'ok' if not faults else f'{len(faults)} faults'}")
        for fault in faults[:40]:
            print(f"  {fault}")
        if len(faults) > 40:
            print(f"  ... and {len(faults) - 40} more")
    if bad:
        return 1
    if not asam:
        print("skipped the ASAM quality checker: pip install asam-qc-opendrive")
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
