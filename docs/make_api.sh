#!/usr/bin/env bash
# Writes the API reference by Doxygen: docs/make_api.sh [FOLDER], by default build/docs; then open FOLDER/html/index.html.
# Exit status 1 where Doxygen warns (docs/doxygen/Doxyfile says of what), 77 where it is not installed.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
command -v doxygen >/dev/null || { echo "doxygen is not installed: no API reference (Debian: apt-get install doxygen)" >&2; exit 77; }
export RICCI_DOCS_OUTPUT=${1:-build/docs}
mkdir -p "$RICCI_DOCS_OUTPUT"
doxygen docs/doxygen/Doxyfile
echo "wrote $RICCI_DOCS_OUTPUT/html/index.html"
