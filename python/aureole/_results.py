# SPDX-License-Identifier: Apache-2.0
"""Results that are tables: columns of numbers, as CSV files and as HTML in notebooks."""
from __future__ import annotations

import csv
import html
import io
import os
from typing import Any, Dict, List, Optional

import numpy as np

from . import _aureole
from ._arrays import file_path

_SHOWN_ROWS = 24


class Table:
    """A result with columns of equal length. Subclasses say which."""

    def columns(self) -> Dict[str, Any]:
        """Arrays by the names of the columns, with their units in the names where they have one."""
        raise NotImplementedError

    def to_csv(self, path: "str | os.PathLike[str] | None" = None) -> Optional[str]:
        """The table as comma-separated values with a line of names.

        Parameters
        ----------
        path : path-like, optional
            The file to write, atomically; without it the text is returned.

        Returns
        -------
        str or None
        """
        written = io.StringIO()
        writer = csv.writer(written, lineterminator="\n")
        columns = self.columns()
        writer.writerow(columns)
        writer.writerows(zip(*(_plain(values) for values in columns.values())))
        if path is None:
            return written.getvalue()
        _aureole.write_file(file_path("path", path), written.getvalue().encode())
        return None

    def _title(self) -> str:
        return ""

    def _repr_html_(self) -> str:
        columns = {name: _plain(values) for name, values in self.columns().items()}
        rows = list(zip(*columns.values()))
        shown = rows if len(rows) <= _SHOWN_ROWS else rows[: _SHOWN_ROWS // 2] + [tuple("..." for _ in columns)] + rows[-_SHOWN_ROWS // 2:]
        head = "".join(f"<th>{html.escape(name)}</th>" for name in columns)
        body = "".join("<tr>" + "".join(f"<td>{html.escape(_cell(v))}</td>" for v in row) + "</tr>" for row in shown)
        title = "".join(f"<p>{html.escape(line)}</p>" for line in self._title().splitlines())
        return f"{title}<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _plain(values: Any) -> List[Any]:
    return np.asarray(values).tolist() if not isinstance(values, list) else values


def _cell(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
