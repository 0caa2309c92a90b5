#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tools/check_words.py finds planted faults, and nothing in plain text."""
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import check_words


def lines(findings):
    return [line for line, _ in findings]


class Comments(unittest.TestCase):
    def found(self, name, text):
        return lines(check_words.check_comments(Path(name), text))

    def test_openings(self):
        self.assertEqual(self.found("a.h", "/// Those of x.\nint a;\nint b;  // the same, smoothed\n"), [1, 3])
        self.assertEqual(self.found("a.cpp", "// Weights\n// The same line goes on here.\n"), [])

    def test_phrases(self):
        self.assertEqual(self.found("a.sh", "#!/bin/sh\n# It is seldom so.\necho 'a # seldom'\n"), [2])
        self.assertEqual(self.found("a.py", 'def f():\n    """Light amid fog."""\n    return "seldom"  # `seldom` is a name\n'), [2])

    def test_strings_are_no_comments(self):
        self.assertEqual(self.found("a.cpp", 'auto s = "// seldom";\nauto r = R"x(// seldom\n/* amid */)x";\nchar c = \'"\';  // seldom\n'), [4])


class Pages(unittest.TestCase):
    def found(self, text):
        return lines(check_words.check_page(text))

    def test_one_sentence_a_line(self):
        self.assertEqual(self.found("# A. Title\n\nOne. Two.\nA sentence that\ngoes on.\n"), [3, 5])
        self.assertEqual(self.found("- *Head.* One sentence, by A. Author et al. 2020, e.g. this.\n  And one more.\n"), [])

    def test_exempt(self):
        self.assertEqual(self.found("| a. B | .5 |\n\n    code. Code .5\n\n```\nx. Y .5\n```\n<!-- a. B -->\n"), [1])

    def test_numbers(self):
        self.assertEqual(self.found("It is .5 and -.5.\nIt is 0.5, `.5`, a.5 and [x](y/.5).\n"), [1])

    def test_phrases(self):
        self.assertEqual(self.found("This is seldom so.\n"), [1])


if __name__ == "__main__":
    unittest.main()
