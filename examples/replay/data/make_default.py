#!/usr/bin/env python3
"""make_default.py RECORDED.trace.gz OUT.trace.gz: writes a trace of version 1 smaller.

An observation names the number of its feature instead of its position in the image; points are rounded to centimetres,
keyframes to millimetres, times to milliseconds. Nothing else changes; so the replay does the same.
"""
import gzip
import sys
import zlib


def smaller(lines):
    features = {}
    for line in lines:
        a = line.split()
        if a[0] == "O":
            of = features.setdefault(a[1], {})
            number = of.setdefault((a[3], a[4]), len(of))
            yield "o %s %s %d %s %s" % (a[1], a[2], number, a[5], a[6])
        elif a[0] == "P":
            yield "P %s %.2f %.2f %.2f %s" % (a[1], *map(float, a[2:5]), a[5])
        elif a[0] == "K":
            yield " ".join(["K", a[1], *("%.3f" % float(x) for x in a[2:10]), *a[10:]])
        elif a[0] == "F":
            yield "F %s %.3f %s" % (a[1], float(a[2]), a[3])
        elif a[0] != "#":
            yield line.strip()


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    head = ["# slamtrace 1 ORB-SLAM2 (RGB-D) on TUM RGB-D fr1_rpy, played forward, backward, forward: 2167 frames",
            "# images: TUM RGB-D benchmark, CC BY 4.0, J. Sturm, N. Engelhard, F. Endres, W. Burgard and D. Cremers, "
            "A Benchmark for the Evaluation of RGB-D SLAM Systems, IROS 2012"]
    with gzip.open(sys.argv[1], "rt") as recorded:
        text = "\n".join(head + list(smaller(recorded))) + "\n"
    packer = zlib.compressobj(9, zlib.DEFLATED, 31, 9)  # 31: with a gzip header, without a time
    with open(sys.argv[2], "wb") as out:
        out.write(packer.compress(text.encode()) + packer.flush())


main()
