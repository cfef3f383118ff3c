#!/usr/bin/python3
"""Picture of a report in a window of 1400 x 1060 pixels.

usage: tools/docs/screenshot.py duck/report.html docs/report.png ['axis=0&colour=none']
The third argument sets controls of the page by their id. Needs Debian's chromium.
"""
import pathlib
import subprocess
import sys

report, picture, controls = (sys.argv[1:] + [""])[:3]
subprocess.run(["chromium", "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                "--hide-scrollbars", "--window-size=1400,1060", "--timeout=60000",
                f"--screenshot={pathlib.Path(picture).absolute()}",
                f"file://{pathlib.Path(report).absolute()}#{controls}"], check=True, stderr=subprocess.DEVNULL)
