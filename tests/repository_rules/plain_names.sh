#!/usr/bin/env bash
# Identifiers are words that an engineer would look for, and commit subjects say in the imperative what
# was changed (CONTRIBUTING.md).
set -euo pipefail
exec python3 -B tests/repository_rules/plain_names.py
