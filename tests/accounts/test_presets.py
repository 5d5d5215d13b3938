"""The accounts of what is no result: presets and manifests."""

import json

import stepwell as sw
from accounts.schemas import violations
from stepwell import reports
from stepwell.accounts import account, card, page, terminal


def test_the_presets_keep_to_the_schema_and_every_form_has_their_count():
    found = account(sw.presets())
    assert violations(found.record) == []
    assert [one["name"] for one in found.record["presets"]] == list(sw.presets())
    count = f"{len(sw.presets())} designs"
    text = "\n".join(line.text for line in terminal(found, full=True))
    assert all(count in form for form in (text, card(found), page(found)))
    assert all(name in text for name in sw.presets())


def test_the_manifest_of_a_folder_keeps_to_the_schema(tmp_path):
    names = reports.write(sw.check(sw.preset("paper-forward"), samples=5), tmp_path / "out")
    manifest = json.loads((tmp_path / "out" / "stepwell.json").read_text("utf-8"))
    assert violations(manifest) == []
    assert set(manifest["files"]) == set(names)
