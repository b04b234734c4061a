#!/usr/bin/env bash
# The wire contract by buf's STANDARD rules, and formatted. buf comes from npm, pinned; exit 77 (skipped) where neither it
# nor npx is there or it can't be fetched.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../proto"
if command -v buf >/dev/null; then
  buf=(buf)
elif command -v npx >/dev/null; then
  buf=(npx --yes @bufbuild/buf@1.59.0)
else
  echo "skipped: neither buf nor npx is installed"
  exit 77
fi
timeout 120 "${buf[@]}" --version </dev/null || { echo "skipped: buf can't be fetched"; exit 77; }
"${buf[@]}" lint </dev/null
"${buf[@]}" format --diff --exit-code </dev/null
