#!/usr/bin/env python3
"""faiss over the rows of bench_archive: brute force over a mapped file, and IndexFlat read with IO_FLAG_MMAP.

    /usr/bin/python3 tests/bench/peer_archive.py FOLDER [THREADS]      (Debian: python3-faiss)

It prints lines in the form of run.py, and how many of its answers are those of motionlang. IndexFlat of faiss 1.7 copies
the file into memory, whatever the flag says; so it is only tried if the rows are less than half of the memory.
"""
import os
import sys
import time

import faiss
import numpy as np

WIDTH, TOP = 256, 10


def times(f, seconds=10, least=5):
    f()
    out = []
    start = time.perf_counter()
    while len(out) < least or time.perf_counter() - start < seconds:
        before = time.perf_counter()
        f()
        out.append(time.perf_counter() - before)
    return sorted(out)


def report(config, variant, f):
    t = times(f)
    print(f"archive,{config},{variant},{faiss.omp_get_max_threads()},{t[0] * 1e3:.4f},{t[len(t) // 2] * 1e3:.4f},"
          f"{t[len(t) * 9 // 10] * 1e3:.4f},0,0,0", flush=True)


def main():
    folder = sys.argv[1]
    if len(sys.argv) > 2:
        faiss.omp_set_num_threads(int(sys.argv[2]))
    rows = np.memmap(os.path.join(folder, "rows.f32"), dtype=np.float32, mode="r").reshape(-1, WIDTH)
    queries = np.fromfile(os.path.join(folder, "queries.f32"), dtype=np.float32).reshape(-1, WIDTH)
    answers = np.fromfile(os.path.join(folder, "answers.i64"), dtype=np.int64).reshape(-1, TOP)

    def knn(q):
        return faiss.knn(q, rows, TOP, metric=faiss.METRIC_INNER_PRODUCT)[1]

    print(f"{(knn(queries) == answers).all(axis=1).sum()} of {len(answers)} answers are those of motionlang")
    name = f"{len(rows)} rows, "
    report(name + "1 query", "faiss.knn mapped", lambda: knn(queries[:1]))
    report(name + "16 queries", "faiss.knn mapped", lambda: knn(queries[:16]))
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if 2 * rows.nbytes > memory:
        return
    path = os.path.join(folder, "flat.faiss")
    index = faiss.IndexFlatIP(WIDTH)
    for begin in range(0, len(rows), 1 << 16):
        index.add(rows[begin:begin + (1 << 16)])
    faiss.write_index(index, path)
    del index
    start = time.perf_counter()
    index = faiss.read_index(path, faiss.IO_FLAG_MMAP)
    print(f"read_index with IO_FLAG_MMAP: {time.perf_counter() - start:.2f} s")
    report(name + "1 query", "faiss IndexFlatIP", lambda: index.search(queries[:1], TOP))
    report(name + "16 queries", "faiss IndexFlatIP", lambda: index.search(queries[:16], TOP))
    os.remove(path)


if __name__ == "__main__":
    main()
