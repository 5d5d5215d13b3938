"""Made-up exports: one test of a specimen, written as different machines and people write it."""

from collections.abc import Callable, Sequence

import numpy as np

from lab.workbooks import Array, ods, xls, xlsx

# Time [s], stroke [mm] and force [N] of a band that is pulled and let go.
WAY = np.concatenate([np.linspace(0, 20, 61), np.linspace(20, 0, 61)[1:]])
FORCE = np.round(np.where(np.arange(121) <= 60, 0.05, 0.04) * WAY, 4)
TIME = np.arange(121) / 10


def table(
    head: str, columns: Sequence[Array], mark: str = ",", form: Callable[[float], str] = str
) -> str:
    """Lines of a header and rows of numbers."""
    rows = [mark.join(form(float(x)) for x in row) for row in zip(*columns, strict=True)]
    return head + "\n" + "\n".join(rows) + "\n"


def comma(value: float) -> str:
    """A number with a decimal comma."""
    return f"{value:.8f}".replace(".", ",")


def quoted(value: float) -> str:
    """A quoted number with a decimal comma."""
    return f'"{comma(value)}"'


def grouped(value: float) -> str:
    """A number with commas between its thousands."""
    return f"{value:,.1f}"


STANDARD = "Time (s),Displacement (mm),Force (N)"
PLAIN = table(STANDARD, (TIME, WAY, FORCE))
BESIDE = ",".join(["Displacement (mm),Force (N)"] * 2)
_MOST = np.maximum.accumulate(FORCE)
_ONE = np.ones(121)
_AWAY = 3 * np.sin(WAY) + 0.2 * TIME
_NEWTONS, _MICRO = FORCE * 1000, WAY * 1000
_BOTH = (TIME, WAY, FORCE)

# Exports of which one reading stands out: the same stroke and force.
READ: dict[str, str | bytes] = {
    "plain": PLAIN,
    "semicolons and decimal commas": table("Zeit [s];Weg [mm];Kraft [N]", _BOTH, ";", comma),
    "quoted decimal commas": table(STANDARD, _BOTH, ",", quoted),
    "thousands beside a time with points": table(
        "Time (s)\tDisplacement (µm)\tForce (mN)", (TIME, _MICRO, _NEWTONS), "\t", grouped
    ),
    "quoted comma in a name": table(
        'Total Time (s),"Position(Machine (0,1):Position) (mm)","Load(Machine (0,1):Load) (N)"',
        _BOTH,
    ),
    "units below": table("Time,Extension,Load\n(s),(mm),(N)", _BOTH),
    "units after slashes": table("t/s;Displacement / mm;Force / N", _BOTH, ";"),
    "symbols": table("t (s),u (mm),F (N)", _BOTH),
    "spelled units": table("Time in seconds,Travel in millimeters,Load in Newtons", _BOTH),
    "units in the preamble": table(
        "Speed: 10\nUnits: N\nTravel Unit: mm\n\nReading,Load,Travel", (TIME, FORCE, WAY)
    ),
    "Greek micro": table("Displacement (μm),Force (N)", (_MICRO, FORCE)),
    "GBK": table("时间(s),位移(mm),力(N)", _BOTH).encode("gbk"),
    "Latin-1": table("Temps (s);Déplacement (mm);Effort (N)", _BOTH, ";", comma).encode("latin-1"),
    "UTF-16": PLAIN.encode("utf-16"),
    "white space": table("Time Displacement Force\n(s) (mm) (N)", _BOTH, "  "),
    "pounds and inches": table("Extension (in),Load (lbs)", (WAY / 25.4, FORCE / 4.4482216152605)),
    "setpoint first": table(
        "Time (s),Displacement setpoint (mm),Displacement (mm),Force (N)",
        (TIME, np.round(WAY), WAY, FORCE),
    ),
    "maximum first": table(
        "Time (s),Displacement (mm),Max. load (N),Load (N)", (TIME, WAY, _MOST, FORCE)
    ),
    "constant first": table("Displacement (mm),Load Ch1 (N),Load Ch2 (N)", (WAY, 0 * FORCE, FORCE)),
    "raw first": table(
        "Time (s),Raw displacement (mm),Raw force (N),Displacement (mm),Force (N)",
        (TIME, WAY + 3, FORCE + 1, WAY, FORCE),
    ),
    "absolute crosshead": table(
        "Time,Crosshead absolute,Standard travel,Standard force\ns,mm,mm,N",
        (TIME, WAY * 1.02 - 755, WAY, FORCE),
    ),
    "absolute crosshead in French": table(
        '"Capteur de force",""\n"v1",1,"mm/min"\n'
        '"Temps","Traverse absolue","Force standard","Course standard"\n"s","mm","N","mm"',
        (TIME, WAY * 1.02 - 794, FORCE, WAY),
    ),
    "command in steps": table(
        "Time (s),Axial Command (mm),Axial Displacement (mm),Axial Force (N)",
        (TIME, np.where(TIME < 6, 20.0, 0.0), WAY, FORCE),
    ),
    "transverse channel": table(
        "Displacement (mm),Transverse displacement (mm),Force (N)", (WAY, _AWAY, FORCE)
    ),
    "temperatures": table(
        "Time (s),Load cell temp (degrees C),Displacement (mm),Force (N)",
        (TIME, 20 + 0.01 * TIME, WAY, FORCE),
    ),
    "stress and torque": table(
        'Position (mm),Force (N),Stress (MPa),Digital Position (mm),"Cycle Count"',
        (WAY, FORCE, 3 * FORCE, WAY - 1e-5, _ONE),
    ),
    "words beside numbers": "Time (s),State,Displacement (mm),Force (N)\n"
    + "".join(f"{t},IDLE,{x},{f}\n" for t, x, f in zip(*_BOTH, strict=True)),
    "both negative": table(STANDARD, (TIME, -WAY, -FORCE)),
    "force negative": table(STANDARD, (TIME, WAY, -FORCE)),
    "zero far away": table(STANDARD, (TIME, WAY + 300, FORCE)),
    "LabVIEW with a header of each channel": "LabVIEW Measurement\t\nSeparator\tTab\n"
    "***End_of_Header***\t\n\t\nChannels\t2\t\nTime\t10:12:30.5\t10:12:30.5\t\n"
    "Y_Unit_Label\tmm\tN\t\nX_Dimension\tTime\tTime\t\nX0\t0.0\t0.0\t\n"
    "Delta_X\t0.1\t0.1\t\n***End_of_Header***\t\t\t\n"
    + table("X_Value\tDisplacement\tForce\tComment", _BOTH, "\t"),
    "signals of TA Instruments": "Instrument\tDMA Q800\nSize\t12.8100\t6.0200\t1.0300\tmm\n"
    "Sig1\tTime (s)\nSig2\tTemperature (°C)\nSig3\tDisplacement (µm)\n"
    + table("Sig4\tStatic Force (N)\nStartOfData", (TIME, 25 + 0 * TIME, _MICRO, FORCE), "\t"),
    "several header blocks": "Results\nSpecimen,Length\n1,80\n2,81\n\n" + PLAIN,
}


for _write in (xlsx, ods, xls):
    _names = ["Time (s)", "Displacement (mm)", "Force (N)"]
    READ[f"workbook, {_write.__name__}"] = _write(_BOTH, _names)

# Exports that leave a choice, with what the message names.
ASKED: dict[str, tuple[str, str]] = {
    "two forces": (
        table("Displacement (mm),Force A (N),Force B (N)", (WAY, FORCE, 2 * FORCE)),
        "could both be the force",
    ),
    "no header": (table("", _BOTH).lstrip(), "no line above the numbers names"),
    "no units": (table("Time,Displacement,Force", _BOTH), "has no unit"),
    "other units": (table("Displacement (ft),Force (N)", (WAY, FORCE)), "is in 'ft'"),
    "one mark for all commas": (
        table(
            "Displacement (um);Force (mN)",
            (WAY[1:60] * 1000, FORCE[1:60] * 1000),
            ";",
            lambda x: f"{int(x) // 1000 + 1},{int(x) % 1000:03d}",
        ),
        "may have a decimal comma",
    ),
}
