"""The questions of docs/queries.md, asked in DuckDB and in Polars: the same answers, with the page's columns.

`python3 test_queries.py STORE` writes the answers of a store into the page: that of the demo dataset.
"""

import math
import re
import sys
import unittest
from pathlib import Path

import pyarrow.parquet as pq
from plain import SCENE, STORE, rows

PAGE = Path(__file__).resolve().parents[2] / "docs/queries.md"
SETUP = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
QUESTION = re.compile(r"^```sql\n(?P<sql>.*?)^```$(?P<answer>[^#]*)", re.MULTILINE | re.DOTALL)
SHOWN = 4
"""Rows of an answer that the page shows."""


def engines(store):
    """Two ways to ask a store, as the page sets them up: their answers are names of columns, and rows."""
    duckdb, polars = (code.replace("dataset/", f"{store}/") for code in SETUP.findall(PAGE.read_text()))
    names = {}
    exec(duckdb, names)  # noqa: S102
    exec(polars, names)  # noqa: S102
    db, ask = names["db"], names["ask"]

    def in_duckdb(query):
        found = db.execute(query)
        return [column[0] for column in found.description], found.fetchall()

    def in_polars(query):
        frame = ask(query)
        return frame.columns, frame.rows()

    return in_duckdb, in_polars


def same(one, two):
    """Equal, but for the last digits of a mean."""
    if isinstance(one, float) and isinstance(two, float):
        return math.isclose(one, two, rel_tol=1e-9, abs_tol=1e-12)
    return one == two


def lines(text):
    """Rows of the table in an answer: the names of the columns first."""
    rows = [line for line in text.splitlines() if line.startswith("|") and not line.startswith("|-")]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


class Queries(unittest.TestCase):
    def test_both_engines_give_the_answers_that_the_page_shows(self):
        try:
            in_duckdb, in_polars = engines(STORE)
        except ImportError as lacking:
            self.skipTest(f"{lacking.name}, for the queries of docs/queries.md")
        questions = list(QUESTION.finditer(PAGE.read_text()))
        self.assertGreaterEqual(len(questions), 10)
        for question in questions:
            with self.subTest(question["sql"]):
                names, found = in_duckdb(question["sql"])
                self.assertTrue(found)
                same_names, same_rows = in_polars(question["sql"])
                self.assertEqual(names, same_names)
                for one, two in zip(found, same_rows, strict=True):
                    self.assertTrue(all(map(same, one, two)), (one, two))
                self.assertEqual(lines(question["answer"])[0], names)

    def test_every_table_says_whose_it_is(self):
        files = [file for file in SCENE.rglob("*.parquet") if pq.read_metadata(file).num_rows]
        self.assertGreater(len(files), 20)
        for file in files:
            with self.subTest(file):
                self.assertEqual(set(pq.read_table(file, columns=["scene"])["scene"].to_pylist()), {0})

    def test_the_ego_is_marked(self):
        own = {row["agent"]: row["id"] for row in rows(SCENE / "agents.parquet")}
        for table in ("boxes", "boxes_valid"):
            marked = {(row["agent"], row["id"]) for row in rows(SCENE / f"{table}.parquet", is_ego=True)}
            others = {(row["agent"], row["id"]) for row in rows(SCENE / f"{table}.parquet", is_ego=False)}
            # A unit on a pole is no object that has a box.
            self.assertEqual(marked, {pair for pair in own.items() if not pair[0].startswith("rsu")})
            self.assertFalse(others & set(own.items()))


def shown(value):
    if isinstance(value, float):
        return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
    return "" if value is None else str(value)


def main():
    """Writes answers into the page."""
    ask, _ = engines(Path(sys.argv[1]).resolve())

    def answered(question):
        names, found = ask(question["sql"])
        table = [names, ["---"] * len(names), *([shown(value) for value in row] for row in found[:SHOWN])]
        count = f"{len(found)} row{'s' if len(found) != 1 else ''}"
        first = f", the first {SHOWN}" if len(found) > SHOWN else ""
        text = "\n".join(f"| {' | '.join(row)} |" if row[0] != "---" else f"|{'|'.join(row)}|" for row in table)
        return f"```sql\n{question['sql']}```\n\n{count}{first}:\n\n{text}\n\n"

    PAGE.write_text(QUESTION.sub(answered, PAGE.read_text()).rstrip() + "\n")


if __name__ == "__main__":
    main()
