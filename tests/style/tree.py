"""Lists the files of a source tree."""

import os
import subprocess

SKIPPED_FOLDERS = {".git", "build", "node_modules", "quickstart-output", "__pycache__"}


def source_files(root):
    """Paths relative to `root`, sorted: what git tracks or would add; every file outside build
    folders where `root` is not the top of a git work tree. Deleted files are left out."""
    if (root / ".git").exists():
        answer = subprocess.run(
            ["git", "-C", str(root), "ls-files", "-z", "-co", "--exclude-standard"],
            capture_output=True,
            check=False,
        )
        if answer.returncode == 0:
            names = answer.stdout.decode("utf-8", "replace").split("\0")
            return sorted(n for n in set(names) if n and (root / n).is_file())
    found = []
    for folder, folders, names in os.walk(root):
        folders[:] = [f for f in folders if f not in SKIPPED_FOLDERS]
        found += [os.path.relpath(os.path.join(folder, n), root) for n in names]
    return sorted(found)
