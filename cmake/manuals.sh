#!/usr/bin/env bash
# Makes the manuals from what the programs' --help says.
# usage: manuals.sh HELP2MAN PROGRAM-FOLDER OUTPUT-FOLDER     leaves cli/*.1, coordinator/*.8, worker/*.8
set -euo pipefail
help2man=$1
programs=$2
output=$3

rm -rf "$output"
mkdir -p "$output"/{cli,coordinator,worker}
export PATH=$programs:$PATH TZ=UTC0
# The date of the page is that of the sources where somebody says so, for the same bytes.
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(date +%s)}

# manual NAME SUMMARY SECTION FILE COMMAND...
manual() {
  local name=$1 summary=$2 section=$3 file=$4
  shift 4
  "$help2man" --no-info --section="$section" --name="$summary" --source="depthfarm $version" \
    --manual="depthfarm" --version-string="$version" --include=<(printf '[SEE ALSO]\n%s\n' "$see_also") "$*" |
    # help2man takes the name from the program; a manual of a command is its own page.
    sed "s/^\\.TH [^ ]* \"\([0-9]\)\" \"[^\"]*\"/.TH ${name^^} \"\1\" \"$day\"/; /^\\.\\\\\" DO NOT MODIFY/d; s/^$* \\\\- /$name \\\\- /" |
    gzip -9n >"$file"
}

day=$(date -u -d "@$SOURCE_DATE_EPOCH" +%F)
version=$(depthfarm --version | sed 's/^depthfarm //')
commands=$(depthfarm --help | awk '/^Subcommands:/ {on = 1; next} /^$/ {on = 0} on {print $1}')
all=$(for command in $commands; do printf 'depthfarm-%s(1), ' "$command"; done)
see_also="${all}depthfarm-coordinator(8), depthfarm-worker(8)"
manual depthfarm "depth maps for multi-camera video" 1 "$output/cli/depthfarm.1.gz" depthfarm
see_also='depthfarm(1), depthfarm-coordinator(8), depthfarm-worker(8)'
for command in $commands; do
  summary=$(depthfarm --help | awk -v command="$command" '$1 == command {sub(/^ *[^ ]+ +/, ""); print; exit}')
  manual "depthfarm-$command" "$summary" 1 "$output/cli/depthfarm-$command.1.gz" depthfarm "$command"
done
for action in up status down; do
  manual "depthfarm-cluster-$action" "a farm on machines of an engine: $action" 1 "$output/cli/depthfarm-cluster-$action.1.gz" \
    depthfarm cluster "$action"
done
manual depthfarm-media "commands of depthfarm that work on pictures and depth maps" 1 "$output/cli/depthfarm-media.1.gz" \
  depthfarm-media
see_also='depthfarm(1), depthfarm-worker(8)'
manual depthfarm-coordinator "plans depth estimation jobs and hands their tasks to workers" 8 \
  "$output/coordinator/depthfarm-coordinator.8.gz" depthfarm-coordinator
see_also='depthfarm(1), depthfarm-coordinator(8)'
manual depthfarm-worker "computes tasks of a depthfarm" 8 "$output/worker/depthfarm-worker.8.gz" depthfarm-worker
touch "$output/stamp"
