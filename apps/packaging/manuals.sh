#!/bin/sh
# Man pages made of the program's help: sh manuals.sh PROGRAM FOLDER
set -eu
program="$1"
folder="$2"
mkdir -p "$folder/man"

# page NAME DOES HELP...: the help as it is printed, backslashes, dashes and control lines escaped
page() {
  name="$1"
  does="$2"
  shift 2
  {
    printf '.TH "%s" 1 "" "rigfit %s" "rigfit"\n.SH NAME\n%s \\- %s\n.SH DESCRIPTION\n.nf\n' \
      "$name" "$("$program" --version)" "$name" "$does"
    "$program" "$@" | sed "s/\\\\/\\\\e/g; s/-/\\\\-/g; s/^\\([.']\\)/\\\\\\&\\1/"
    printf '.fi\n.SH EXIT STATUS\n0 done; 2 usage error; 3 unreadable input; 4 refused: the data cannot support what '
    printf 'was asked; 5 did not converge; 1 an internal error.\n'
  } >"$folder/man/$name.1"
}

page rigfit "parameters of cables and beams from test recordings" help
for verb in $("$program" help | sed -n '/^Verbs:/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
  page "rigfit-$verb" "$("$program" help "$verb" | sed -n 1p)" help "$verb"
done
