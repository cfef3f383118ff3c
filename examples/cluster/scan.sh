#!/bin/sh
# scan.sh SCAN NAME FOLDER [OPTIONS of umtet run]: makes the case FOLDER/NAME, with the answer and what was said in FOLDER/logs, as
# `umtet batch --collect` reads them. Ends with 0 also where another try would only repeat a refusal: that is a row of the table.
# $UMTET is the program.
set -u
scan=$1 name=$2 folder=$3
shift 3
mkdir -p "$folder/logs"
answer=$folder/logs/$name.json
rm -f "$answer"
"${UMTET:-umtet}" run "$scan" -o "$folder/$name" --json --progress none "$@" >"$answer.part" 2>"$folder/logs/$name.log"
status=$?
# Stopped in the middle (130, 143): the next attempt goes on with what the records of the case say is finished.
case $status in 0 | 3 | 4 | 5 | 6) status=0 ;; esac
mv "$answer.part" "$answer"
cat "$folder/logs/$name.log" >&2
exit $status
