#!/usr/bin/python3
"""The scans of a list as arrays of Slurm jobs, one array for each size of memory and time, and a last job that makes the table.

usage: submit.py LIST -o FOLDER [--parameters='--tets 100000'] [--options='--export msh'] [--attempt 2] [--all] [--print]

Scans that have an answer are left out, so the same command again submits what was stopped, or had too little time or memory; give
it --attempt 2 then, and it asks for what several meshes take. --print shows the calls of sbatch and makes none."""
import argparse
import json
import pathlib
import shlex
import subprocess

from scans import SETTLED, listed, resources

HERE = pathlib.Path(__file__).resolve().parent


def is_settled(answer):
    try:
        return json.loads(answer.read_text())["exit_code"] in SETTLED
    except (OSError, ValueError, KeyError):
        return False


def power_of_two(x):
    return 1 << max(0, x - 1).bit_length()


def inspect(umtet, scan, parameters, file):
    """The answer of umtet inspect --json, also where that refuses the scan."""
    file.parent.mkdir(parents=True, exist_ok=True)
    call = subprocess.run([umtet, "inspect", str(scan), *parameters, "--json"], stdout=subprocess.PIPE, text=True)
    if call.returncode not in (0, 3, 7):
        raise SystemExit(f"submit.py: {umtet} inspect {scan} ended with {call.returncode}")
    file.write_text(call.stdout)
    return file


def arrays(args, scans):
    """{(megabytes, minutes): [numbers of scans]}, rounded up to powers of two."""
    logs = args.folder / "logs"
    found = {}
    for number, (name, scan) in enumerate(scans.items(), 1):
        if not args.all and is_settled(logs / f"{name}.json"):
            continue
        ask = resources(inspect(args.umtet, scan, shlex.split(args.parameters), logs / "inspect" / f"{name}.json"),
                        args.attempt, args.threads)
        found.setdefault(tuple(power_of_two(ask[key]) for key in ("mem_mb", "minutes")), []).append(number)
    return found


def calls(args):
    """The words of every call of sbatch; {ids} stands for those of the calls before."""
    scans = listed(args.list)
    (args.folder / "logs").mkdir(parents=True, exist_ok=True)
    (args.folder / "logs/scans.tsv").write_text("".join(f"{name}\t{scan}\n" for name, scan in scans.items()))
    words = [*shlex.split(args.parameters), *shlex.split(args.options)]
    for (megabytes, minutes), numbers in sorted(arrays(args, scans).items()):
        yield ["sbatch", "--parsable", f"--array={','.join(map(str, numbers))}", f"--mem={megabytes}M", f"--time={minutes}",
               f"--cpus-per-task={args.threads}", f"--export=ALL,UMTET={args.umtet}", str(HERE / "array.sh"), str(HERE),
               str(args.folder), *words]
    table = [args.umtet, "batch", str(args.list), "-o", str(args.folder), "--collect"]
    yield ["sbatch", "--parsable", "--dependency=afterany:{ids}", "--mem=256M", "--time=10", "--wrap", shlex.join(table)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("list", type=lambda p: pathlib.Path(p).resolve())
    parser.add_argument("-o", dest="folder", required=True, type=lambda p: pathlib.Path(p).resolve(), help="of all cases; shared by the machines")
    parser.add_argument("--umtet", default="umtet", help="the program, the same on all machines")
    parser.add_argument("--parameters", default="", help="flags for umtet inspect and umtet run: --h, --tets, --max-tets, --config, --set")
    parser.add_argument("--options", default="", help="further flags of umtet run")
    parser.add_argument("--threads", type=int, default=1, help="of a scan")
    parser.add_argument("--attempt", type=int, default=1, help="2 and more ask for more")
    parser.add_argument("--all", action="store_true", help="scans with an answer too: parameters or the program have changed")
    parser.add_argument("--print", action="store_true", help="show the calls only")
    args = parser.parse_args()
    ids = []
    for call in calls(args):
        if "--dependency=afterany:{ids}" in call and not ids:
            call = [word for word in call if not word.startswith("--dependency")]
        call = [word.replace("{ids}", ":".join(ids)) if word.startswith("--dependency") else word for word in call]
        print(shlex.join(call), flush=True)
        # sbatch --parsable prints the number of the job, and the cluster behind a semicolon
        ids.append("ID" if args.print else subprocess.check_output(call, text=True).split(";")[0].strip())


if __name__ == "__main__":
    main()
