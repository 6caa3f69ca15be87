"""What `kubectl kustomize` makes of a folder, as much of it as deploy/kubernetes uses: Debian has none that knows today's
files. Whatever else a file asks for is an error, never passed over. Where a real one is at hand the test holds this one
against it."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import yaml

# The field by which elements of a list are known, as the API declares it (x-kubernetes-patch-merge-key); other lists are
# replaced.
MERGE_KEYS = {
    "containers": "name", "initContainers": "name", "volumes": "name", "env": "name", "volumeMounts": "mountPath",
    "imagePullSecrets": "name",
}


class ManifestError(Exception):
    """A file that cannot be used; the text names it."""


class StrictLoader(yaml.SafeLoader):
    """A key that is given twice is an error, where YAML's usual reader takes the last."""


def _mapping(loader: StrictLoader, node: yaml.MappingNode) -> dict:
    keys = [loader.construct_object(key) for key, _ in node.value]
    twice = {key for key in keys if keys.count(key) > 1}
    if twice:
        raise ManifestError(f"line {node.start_mark.line + 1}: {', '.join(sorted(map(str, twice)))} is given twice")
    return loader.construct_mapping(node, deep=True)


StrictLoader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _mapping)


def load(file: Path) -> list[dict]:
    """The documents of a YAML file."""
    try:
        documents = list(yaml.load_all(file.read_text(), StrictLoader))  # noqa: S506, of SafeLoader
    except (OSError, yaml.YAMLError, ManifestError) as error:
        raise ManifestError(f"{file}: {error}") from error
    for document in documents:
        if not isinstance(document, dict) or "kind" not in document or "name" not in document.get("metadata", {"name": ""}):
            raise ManifestError(f"{file}: a document is no object with a kind and a name")
    return documents


def identity(document: dict) -> tuple[str, str, str]:
    return document["apiVersion"], document["kind"], document["metadata"]["name"]


def merged(base: Any, patch: Any, field: str = "") -> Any:
    """A strategic merge: objects by key, lists that have a merge key by that, null takes away."""
    if isinstance(base, dict) and isinstance(patch, dict):
        if any(key.startswith("$") for key in patch):
            raise ManifestError(f"{field}: directives of patches are not known here")
        result = dict(base)
        for key, value in patch.items():
            if value is None:
                result.pop(key, None)
            else:
                result[key] = merged(base[key], value, key) if key in base else copy.deepcopy(value)
        return result
    if isinstance(base, list) and isinstance(patch, list) and field in MERGE_KEYS:
        key = MERGE_KEYS[field]
        by_key = {element[key]: element for element in base}
        new = {element[key]: element for element in patch}
        return [merged(element, new[element[key]]) if element[key] in new else element for element in base] + [
            element for name, element in new.items() if name not in by_key]
    return copy.deepcopy(patch)


def pod_template(document: dict) -> dict | None:
    """The pod that a document makes, as {"metadata", "spec"}."""
    return document["spec"]["template"] if document["kind"] in ("Deployment", "StatefulSet", "Job") else None


def _name_images(documents: list[dict], images: list[dict]) -> None:
    for image in images:
        unknown = set(image) - {"name", "newName", "newTag"}
        if unknown:
            raise ManifestError(f"images: {sorted(unknown)} are not known here")
    by_name = {image["name"]: image for image in images}
    for document in documents:
        pod = (pod_template(document) or {}).get("spec", {})
        for container in pod.get("initContainers", []) + pod.get("containers", []):
            name, _, tag = container["image"].partition(":")
            if name in by_name:
                new = by_name[name]
                tag = new.get("newTag", tag)
                container["image"] = new.get("newName", name) + (f":{tag}" if tag else "")


def build(folder: Path) -> list[dict]:
    """The documents of a kustomization, in order."""
    file = folder / "kustomization.yaml"
    kustomization = load(file)[0]
    unknown = set(kustomization) - {"apiVersion", "kind", "namespace", "resources", "patches", "images"}
    if unknown:
        raise ManifestError(f"{file}: {sorted(unknown)} are not known here")
    documents: list[dict] = []
    for resource in kustomization["resources"]:
        path = folder / resource
        documents += build(path) if path.is_dir() else load(path)
    identities = [identity(document) for document in documents]
    if len(set(identities)) != len(identities):
        raise ManifestError(f"{file}: two documents are of one kind and name")
    for entry in kustomization.get("patches", []):
        if set(entry) != {"path"}:
            raise ManifestError(f"{file}: a patch has {sorted(entry)}, only path is known here")
        for patch in load(folder / entry["path"]):
            if identity(patch) not in identities:
                raise ManifestError(f"{folder / entry['path']}: there is no {' '.join(identity(patch))} to change")
            index = identities.index(identity(patch))
            documents[index] = merged(documents[index], patch)
    if "namespace" in kustomization:
        for document in documents:
            if document["kind"] == "Namespace":
                document["metadata"]["name"] = kustomization["namespace"]
            else:
                document["metadata"]["namespace"] = kustomization["namespace"]
    _name_images(documents, kustomization.get("images", []))
    return documents


def files_of(folder: Path) -> set[Path]:
    """The files that a kustomization is made of."""
    kustomization = load(folder / "kustomization.yaml")[0]
    files = {(folder / "kustomization.yaml").resolve()}
    for name in kustomization["resources"] + [entry["path"] for entry in kustomization.get("patches", [])]:
        path = (folder / name).resolve()
        files |= files_of(path) if path.is_dir() else {path}
    return files
