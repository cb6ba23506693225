#!/bin/sh
# Man pages, as the program itself writes them: sh manuals.sh PROGRAM FOLDER
set -eu
program="$1"
folder="$2"
mkdir -p "$folder/man"
"$program" help man >"$folder/man/rigfit.1"
for verb in $("$program" help | sed -n '/^Verbs:/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
  "$program" help man "$verb" >"$folder/man/rigfit-$verb.1"
done
