"""Seconds of several programs in turn, what to say of them, and on which machine they were taken."""

import math
import os
import platform
import statistics
from dataclasses import asdict, dataclass
from pathlib import Path


@dataclass(frozen=True)
class Spread:
    """Median, least and greatest of some measurements."""

    median: float
    least: float
    greatest: float
    runs: int

    @classmethod
    def of(cls, values):
        return cls(statistics.median(values), min(values), max(values), len(values))

    def json(self):
        return asdict(self)


def in_turn(runners, runs, twice=False):
    """Spread by name of what each of `runners`, callables by name, returns: A B C A B C, so that what else the machine
    does falls on all alike. What fails is left out, with its reason: (spreads, reasons).

    `twice`: of each two runs the second one counts. What takes some milliseconds only would be measured with the caches
    of the program before, whose worker threads go on asking for work for a while."""
    values, reasons = {name: [] for name in runners}, {}
    for _ in range(runs):
        for name, run in runners.items():
            if name in reasons:
                continue
            try:
                if twice:
                    run()
                values[name].append(run())
            except Exception as error:  # a peer's trouble must not end the others' measurements
                reasons[name] = f"{type(error).__name__}: {error}".strip().splitlines()[0][:200]
    return {name: Spread.of(v) for name, v in values.items() if v and name not in reasons}, reasons


def geometric_mean(values):
    return math.exp(statistics.fmean(map(math.log, values)))


def power_law(x, y):
    """(exponent, factor) of y = factor x^exponent by least squares of the logarithms; two points or more."""
    log_x, log_y = [math.log(v) for v in x], [math.log(v) for v in y]
    line = statistics.linear_regression(log_x, log_y)
    return line.slope, math.exp(line.intercept)


def machine():
    """What the figures belong to: processor, cores, memory, system."""
    return {
        "processor": _field("/proc/cpuinfo", "model name") or platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "memory_GiB": round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30),
        "system": f"{platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "load_before": round(os.getloadavg()[0], 2),
    }


def _field(path, name):
    """The value of a line `name: value` of a file of the kernel, None where there is none."""
    try:
        lines = Path(path).read_text().splitlines()
    except OSError:
        return None
    return next((line.partition(":")[2].strip() for line in lines if line.startswith(name)), None)
