from types import SimpleNamespace

import pytest
from fleet_samples import write_motor, write_poison

from nxt_twin.fleet.parcel import Options
from nxt_twin.fleet.run import diagnose_fleet
from nxt_twin.fleet.table import FleetTable
from nxt_twin.fleet.workers.place import Here


@pytest.fixture(scope="session")
def done_fleet(tmp_path_factory):
    """A fleet of two good sessions and a poisoned one, with its table."""
    folder = tmp_path_factory.mktemp("fleet")
    root = folder / "units"
    write_motor(root / "batch=B1" / "unit=loaded" / "session=2026-03-01" / "run.csv", load_nm=0.05)
    write_motor(root / "batch=B1" / "unit=plain" / "run.parquet", seed=2)
    write_poison(root / "batch=B2" / "unit=poisoned" / "session=2026-03-02" / "run.csv")
    path = folder / "fleet.parquet"
    with FleetTable(path) as table:
        tally = diagnose_fleet([str(root)], table, Options(), Here())
    return SimpleNamespace(root=root, path=path, tally=tally)
