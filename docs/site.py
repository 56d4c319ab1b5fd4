"""Builds the documentation as a site: `python docs/site.py`. Also a hook of MkDocs (mkdocs.yml), for what lies outside docs/.

Pages of the repository's root (changelog, contributing, security) are taken in. Links to other files outside docs/
have no place in the site: their text stays, without the link.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TAKEN_IN = {"changelog.md": "CHANGELOG.md", "contributing.md": "CONTRIBUTING.md", "security.md": "SECURITY.md"}
LINK = re.compile(r"(?<!!)\[([^\]]+)\]\(([^)\s]+)\)")


def on_files(files, config):
    """Adds the pages of the root."""
    from mkdocs.structure.files import File

    for name, source in TAKEN_IN.items():
        files.append(File.generated(config, name, content=(ROOT / source).read_text(encoding="utf-8")))
    return files


def on_page_markdown(markdown, page, config, files):
    """Leads links of a page to where things are in the site."""
    from_root = page.file.src_uri in TAKEN_IN
    folder = ROOT if from_root else (ROOT / "docs" / page.file.src_uri).parent

    def lead(match):
        text, target = match.groups()
        if re.match(r"[a-z]+:|#", target):
            return match[0]
        path, _, part = target.partition("#")
        place = (folder / path).resolve()
        part = f"#{part}" if part else ""
        for name, source in TAKEN_IN.items():
            if place == ROOT / source:
                return f"[{text}]({up(page)}{name}{part})"
        if place == ROOT / "README.md":
            return f"[{text}]({up(page)}README.md)"
        if place.is_relative_to(ROOT / "docs") and place.is_file():
            return f"[{text}]({up(page)}{place.relative_to(ROOT / 'docs').as_posix()}{part})"
        return text

    return LINK.sub(lead, markdown)


def up(page):
    """From a page's folder to the top of the site."""
    return "../" * page.file.src_uri.count("/")


def main():
    """Builds the site into target/docs-site."""
    try:
        from mkdocs.__main__ import cli
    except ImportError:
        print("the site is built by MkDocs: pip install mkdocs-material", file=sys.stderr)
        return 1
    cli(["build", "--config-file", str(ROOT / "mkdocs.yml")])
    return 0


if __name__ == "__main__":
    sys.exit(main())
