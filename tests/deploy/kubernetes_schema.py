"""Documents against the schemas that Kubernetes publishes. Debian's python3-kubernetes is made of them: each class has the
fields of an object and their types, and refuses an object that lacks a required one. Unlike the server's, which drop it, the
check refuses a field that is not known.

Its schemas are of Kubernetes 1.22. HorizontalPodAutoscaler of autoscaling/v2, which came after, has the shape of v2beta2.
KEDA's object is not among them: SCALED_OBJECT tells what of its reference deploy/kubernetes uses."""

from __future__ import annotations

import re
from typing import Any

from kubernetes.client import models

MODELS = {
    ("v1", "Namespace"): "V1Namespace",
    ("v1", "ConfigMap"): "V1ConfigMap",
    ("v1", "PersistentVolumeClaim"): "V1PersistentVolumeClaim",
    ("v1", "Service"): "V1Service",
    ("apps/v1", "StatefulSet"): "V1StatefulSet",
    ("apps/v1", "Deployment"): "V1Deployment",
    ("batch/v1", "Job"): "V1Job",
    ("networking.k8s.io/v1", "NetworkPolicy"): "V1NetworkPolicy",
    ("policy/v1", "PodDisruptionBudget"): "V1PodDisruptionBudget",
    ("autoscaling/v2", "HorizontalPodAutoscaler"): "V2beta2HorizontalPodAutoscaler",
}

# Words of which one is expected; these schemas call them texts.
WORDS = {
    "protocol": {"TCP", "UDP", "SCTP"},
    "operator": {"In", "NotIn", "Exists", "DoesNotExist"},
    "accessModes": {"ReadWriteOnce", "ReadOnlyMany", "ReadWriteMany", "ReadWriteOncePod"},
    "policyTypes": {"Ingress", "Egress"},
    "medium": {"", "Memory"},
    "fsGroupChangePolicy": {"Always", "OnRootMismatch"},
    "restartPolicy": {"Always", "OnFailure", "Never"},
}
QUANTITY = re.compile(r"\d+(\.\d+)?(m|k|M|G|T|P|E|Ki|Mi|Gi|Ti|Pi|Ei)?")
NAME = re.compile(r"[a-z0-9]([-a-z0-9]{0,61}[a-z0-9])?")

SCALED_OBJECT = {
    "apiVersion": "str", "kind": "str", "metadata": "V1ObjectMeta",
    "spec": {
        "scaleTargetRef": {"apiVersion": "str", "kind": "str", "name": "str"},
        "minReplicaCount": "int", "maxReplicaCount": "int", "pollingInterval": "int", "cooldownPeriod": "int",
        "advanced": {"horizontalPodAutoscalerConfig": {"behavior": "V2beta2HorizontalPodAutoscalerBehavior"}},
        "triggers": [{
            "type": "str", "metricType": "str",
            "metadata": {"serverAddress": "str", "query": "str", "threshold": "str", "ignoreNullValues": "str"},
        }],
    },
}

SIMPLE = {"str": str, "int": int, "bool": bool, "float": (int, float), "datetime": str}


def _check_simple(kind: str, value: Any, where: str) -> list[str]:
    # True is an int to Python.
    right = isinstance(value, SIMPLE[kind]) and (kind == "bool") == isinstance(value, bool)
    return [] if right else [f"{where} is {value!r}, expected {kind}"]


def _check_model(name: str, value: Any, where: str) -> list[str]:
    model = getattr(models, name)
    if not isinstance(value, dict):
        return [f"{where} is {value!r}, expected an object"]
    python_names = {json_name: python_name for python_name, json_name in model.attribute_map.items()}
    problems = [f"{where}.{key} is not known to {name}" for key in value if key not in python_names]
    known = {key: entry for key, entry in value.items() if key in python_names}
    for key, entry in known.items():
        problems += _check(model.openapi_types[python_names[key]], entry, f"{where}.{key}", key)
    try:
        model(**{python_names[key]: entry for key, entry in known.items()})
    except ValueError as error:
        problems.append(f"{where}: {error}")
    return problems


def _check(kind: Any, value: Any, where: str, field: str = "") -> list[str]:
    problems = []
    if isinstance(kind, dict):
        if not isinstance(value, dict):
            return [f"{where} is {value!r}, expected an object"]
        problems = [f"{where}.{key} is not known" for key in value if key not in kind]
        for key, of_key in kind.items():
            problems += _check(of_key, value[key], f"{where}.{key}", key) if key in value else [f"{where} has no {key}"]
        return problems
    if isinstance(kind, list) or kind.startswith("list["):
        if not isinstance(value, list):
            return [f"{where} is {value!r}, expected a list"]
        of_element = kind[0] if isinstance(kind, list) else kind[len("list["):-1]
        for index, element in enumerate(value):
            problems += _check(of_element, element, f"{where}[{index}]", field)
        return problems
    if kind.startswith("dict("):
        if not isinstance(value, dict):
            return [f"{where} is {value!r}, expected an object"]
        of_value = kind[len("dict("):-1].split(", ", 1)[1]
        for key, entry in value.items():
            problems += _check(of_value, entry, f"{where}.{key}")
            if field in ("requests", "limits") and not (isinstance(entry, str) and QUANTITY.fullmatch(entry)):
                problems.append(f"{where}.{key} is {entry!r}, expected a quantity")
        return problems
    if kind == "object":  # a number or a text: ports by name, shares in percent
        return [] if type(value) in (int, str) else [f"{where} is {value!r}, expected a number or a text"]
    if kind not in SIMPLE:
        return _check_model(kind, value, where)
    problems = _check_simple(kind, value, where)
    if field in WORDS and value not in WORDS[field]:
        problems.append(f"{where} is {value!r}, expected one of {sorted(WORDS[field])}")
    return problems


def schema_problems(document: dict) -> list[str]:
    """What is wrong with a document; nothing if it is as the API wants it."""
    version, kind = document.get("apiVersion"), document.get("kind")
    name = str(document.get("metadata", {}).get("name"))
    where = f"{kind} {name}"
    problems = [] if NAME.fullmatch(name) else [f"{where}: the name is not one"]
    if (version, kind) == ("keda.sh/v1alpha1", "ScaledObject"):
        return problems + _check(SCALED_OBJECT, document, where)
    if (version, kind) not in MODELS:
        return [f"{where}: there is no schema of {version} {kind}"]
    return problems + _check_model(MODELS[version, kind], document, where)
