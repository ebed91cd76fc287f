"""Where results go: build/bench, a JSON, a Markdown and a text file for each."""

import json
from pathlib import Path

from .measuring import machine

FOLDER = Path(__file__).resolve().parents[1] / "build" / "bench"


def save(name, values, tables, folder=FOLDER):
    """Print tables, and write them and `values`, plain data, with the machine's description. The JSON file's path."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = "\n\n".join(table.text() for table in tables)
    print(texts, flush=True)
    Path(folder, f"{name}.txt").write_text(texts + "\n")
    Path(folder, f"{name}.md").write_text("\n\n".join(table.markdown() for table in tables) + "\n")
    path = Path(folder, f"{name}.json")
    path.write_text(json.dumps({"name": name, "machine": machine(), **values}, indent=1) + "\n")
    return path


def load(name, folder=FOLDER):
    """What `save` wrote as JSON, None where it did not."""
    path = Path(folder, f"{name}.json")
    return json.loads(path.read_text()) if path.is_file() else None
