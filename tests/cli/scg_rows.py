"""Rows of tests/reference/scg_policies as command lines of `gust eval`, and the acceptance of that folder's README."""

import pathlib

REFERENCE = pathlib.Path(__file__).resolve().parent.parent / "reference" / "scg_policies"
POLICIES = ["scg-default-ppo-s1", "scg-2022-ppo-s1"]
STATES = ["x", "x_dot", "theta", "theta_dot"]
OPTIONS = {
    "step": ["offset"],
    "impulse": ["offset", "duration", "decay"],
    "scg_impulse": ["offset", "duration", "decay"],
    "sawtooth": ["frequency", "polarity", "phase"],
    "triangle": ["frequency", "polarity", "phase"],
}


def arguments_of(row):
    """The command line of a row, without the program."""
    yield from ("eval", REFERENCE / f"{row['policy']}.onnx", "--plant", "cartpole", "--preset", row["preset"], "--json")
    if row["preset"] == "scg-2022":  # whose actions are normalised; the files say nothing of it
        yield from ("--units", "normalised")
    yield from ("--start", ",".join(row[f"init_{name}"] for name in STATES))
    yield from ("--terminate", "yes" if row["terminate"] == "1" else "no")
    if row["site"] == "params":
        for name in ("pole_length", "pole_mass", "cart_mass"):
            yield from ("--param", f"{name}={row[name]}")
    elif row["site"] != "none":
        yield from ("--site", row["site"], "--waveform", row["waveform"], "--level", row["level"])
        for option in ["mask", *OPTIONS[row["waveform"]]]:
            yield from ("--set", f"{option}={row[option]}")


def difference(row, got):
    """Why an object that gust printed is not the row's episode; empty if it is."""
    if got["length"] != int(row["length"]) or got["failed"] != (row["failed"] == "1"):
        return f"length {got['length']}, failed {got['failed']}"
    compared = []
    spread_return, spread_state = float(row["spread_return"]), float(row["spread_state"])
    if spread_return <= 0.01:
        tolerance = 1e-6 + 10 * spread_return
        compared += [(name, got[name], tolerance) for name in ("return_sum_commanded", "return_sum_disturbed")]
    if spread_state <= 0.1:
        tolerance = 1e-6 + 10 * spread_state
        compared += [(f"final_{name}", value, tolerance) for name, value in zip(STATES, got["final_state"], strict=True)]
        compared += [(name, got[name], tolerance) for name in ("rmse_paper", "rmse_scg")]
        compared += [("rmse_sum", got["rmse_sum"], 16 * tolerance)]  # sqrt(250 steps)
    for name, value, tolerance in compared:
        if value is None or not abs(value - float(row[name])) <= tolerance:
            return f"{name} is {value}, not {row[name]}, by more than {tolerance:g}"
    return ""
