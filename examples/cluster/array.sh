#!/bin/sh
#SBATCH --job-name=umtet
#SBATCH --nodes=1 --ntasks=1
#SBATCH --output=/dev/null
# One scan of an array: line SLURM_ARRAY_TASK_ID of FOLDER/logs/scans.tsv. submit.py says how much memory and time.
# array.sh HERE FOLDER [OPTIONS of umtet run]; HERE is the folder of scan.sh, since Slurm runs a copy of this file.
set -eu
here=$1 folder=$2
shift 2
line=$(sed -n "${SLURM_ARRAY_TASK_ID}p" "$folder/logs/scans.tsv")
tab=$(printf '\t')
exec "$here/scan.sh" "${line#*"$tab"}" "${line%%"$tab"*}" "$folder" "$@" --threads "${SLURM_CPUS_PER_TASK:-1}"
