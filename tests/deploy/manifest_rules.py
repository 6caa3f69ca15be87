"""What must hold between the documents of a farm, and between them and the programs, beyond their schemas."""

from __future__ import annotations

import re
from dataclasses import dataclass

from kustomization import pod_template

UNITS = {"": 1, "k": 10**3, "M": 10**6, "G": 10**9, "T": 10**12, "Ki": 2**10, "Mi": 2**20, "Gi": 2**30, "Ti": 2**40,
         # As the programs read sizes.
         "KB": 2**10, "MB": 2**20, "GB": 2**30, "TB": 2**40}
# What a worker keeps decoded unless it is told --memory.
WORKER_MEMORY = 2 * 2**30
HAND_BACK_SECONDS = 15
METRICS_PORT = 9470
ARTIFACT_PORT = 7701
UPLOAD_PORT = 7702  # in comments and the README, for --upload-listen


@dataclass
class Facts:
    """What the documents are held against."""

    secrets: dict[str, set[str]]  # files by Secret, as deploy/README.md has them made
    options: dict[str, set[str]]  # of each program, by its --help
    task_bytes: int  # largest task of 1920x1080, by the cost model


@dataclass
class Pod:
    """A pod as some document makes it."""

    name: str
    owner: dict
    labels: dict
    spec: dict
    namespace: str = "depthfarm"

    @property
    def main(self) -> dict:
        return self.spec["containers"][0]

    def port(self, name: str | int) -> int:
        ports = {port["name"]: port["containerPort"] for port in self.main.get("ports", [])}
        return name if isinstance(name, int) else ports.get(name, 0)


def size(text: str) -> int:
    number, unit = re.fullmatch(r"(\d+)([A-Za-z]*)", text).groups()
    return int(number) * UNITS[unit]


def pods_of(documents: list[dict]) -> list[Pod]:
    templates = [(document, pod_template(document)) for document in documents]
    return [Pod(document["metadata"]["name"], document, template["metadata"]["labels"], template["spec"])
            for document, template in templates if template]


def of_kind(documents: list[dict], kind: str) -> list[dict]:
    return [document for document in documents if document["kind"] == kind]


def environment(container: dict, documents: list[dict]) -> dict[str, str]:
    """The variables of a container; what is known only when it runs is its name in braces."""
    variables: dict[str, str] = {}
    maps = {document["metadata"]["name"]: document["data"] for document in of_kind(documents, "ConfigMap")}
    for source in container.get("envFrom", []):
        variables |= maps.get(source["configMapRef"]["name"], {})
    for entry in container.get("env", []):
        source = entry.get("valueFrom", {})
        if "resourceFieldRef" in source:
            kind, resource = source["resourceFieldRef"]["resource"].split(".")
            variables[entry["name"]] = container["resources"][kind][resource]
        elif "fieldRef" in source:
            variables[entry["name"]] = "{" + source["fieldRef"]["fieldPath"] + "}"
        else:
            variables[entry["name"]] = entry["value"]
    return variables


def arguments(container: dict, documents: list[dict]) -> list[str]:
    """What a container runs: $(NAME) of a variable that there is gives its value, another stays, as Kubernetes has it."""
    variables = environment(container, documents)
    return [re.sub(r"\$\((\w+)\)", lambda match: variables.get(match[1], match[0]), word)
            for word in container["command"] + container.get("args", [])]


def option(container: dict, documents: list[dict], name: str) -> str:
    values = [word.partition("=")[2] for word in arguments(container, documents) if word.partition("=")[0] == name]
    return values[0] if values else ""


def _selects(selector: dict, labels: dict) -> bool:
    for expression in selector.get("matchExpressions", []):
        if expression["operator"] != "In":
            raise NotImplementedError(expression["operator"])
        if labels.get(expression["key"]) not in expression["values"]:
            return False
    return all(labels.get(key) == value for key, value in selector.get("matchLabels", {}).items())


def _restricted(pod: Pod) -> list[str]:
    """Kubernetes' "restricted" standard, and what goes beyond it."""
    problems = []
    security = pod.spec.get("securityContext", {})
    if not security.get("runAsNonRoot") or security.get("runAsUser", 0) == 0:
        problems.append("may run as root")
    if security.get("seccompProfile") != {"type": "RuntimeDefault"}:
        problems.append("has no seccomp profile")
    if pod.spec.get("automountServiceAccountToken") is not False:
        problems.append("gets a token of the cluster")
    if any(pod.spec.get(key) for key in ("hostNetwork", "hostPID", "hostIPC")):
        problems.append("shares the host's namespaces")
    for container in pod.spec.get("initContainers", []) + pod.spec["containers"]:
        name, own = container["name"], container.get("securityContext", {})
        if own.get("allowPrivilegeEscalation") is not False or own.get("privileged"):
            problems.append(f"{name} may gain privileges")
        if own.get("readOnlyRootFilesystem") is not True:
            problems.append(f"{name} may write to its root")
        if own.get("capabilities") != {"drop": ["ALL"]}:
            problems.append(f"{name} keeps capabilities")
        if "memory" not in container.get("resources", {}).get("limits", {}):
            problems.append(f"{name} has no bound of memory")
    return problems


def _volumes(pod: Pod, documents: list[dict], facts: Facts) -> list[str]:
    problems = []
    claims = {document["metadata"]["name"] for document in of_kind(documents, "PersistentVolumeClaim")}
    volumes = {volume["name"] for volume in pod.spec["volumes"]}
    volumes |= {claim["metadata"]["name"] for claim in pod.owner["spec"].get("volumeClaimTemplates", [])}
    mounted = set()
    for container in pod.spec["initContainers"] + pod.spec["containers"]:
        names = {mount["name"] for mount in container["volumeMounts"]}
        problems += [f"{container['name']} mounts {name}, which is no volume" for name in names - volumes]
        mounted |= names
    problems += [f"nobody mounts {name}" for name in volumes - mounted]
    for volume in pod.spec["volumes"]:
        if "secret" in volume and volume["secret"]["secretName"] not in facts.secrets:
            problems.append(f"deploy/README.md makes no Secret {volume['secret']['secretName']}")
        if volume.get("persistentVolumeClaim", {"claimName": next(iter(claims), "")})["claimName"] not in claims:
            problems.append(f"there is no claim {volume['persistentVolumeClaim']['claimName']}")
    maps = {document["metadata"]["name"] for document in of_kind(documents, "ConfigMap")}
    for source in pod.main.get("envFrom", []):
        if source["configMapRef"]["name"] not in maps:
            problems.append(f"there is no ConfigMap {source['configMapRef']['name']}")
    return problems


def _options(pod: Pod, documents: list[dict], facts: Facts) -> list[str]:
    command = arguments(pod.main, documents)
    known = facts.options[" ".join(pod.main["command"])]
    names = [word.partition("=")[0] for word in command if word.startswith("-")]
    problems = [f"{command[0]} has no option {name}" for name in names if name not in known]
    problems += [f"{name} is given twice" for name in set(names) if names.count(name) > 1]
    problems += [f"{word}: no such variable" for word in command if "$(" in word]
    ports = {port["containerPort"] for port in pod.main.get("ports", [])}
    for name in ("--listen", "--metrics", "--artifact-listen"):
        told = option(pod.main, documents, name)
        if told and int(told.rpartition(":")[2]) not in ports:
            problems.append(f"{name} is {told}, which is none of its ports {sorted(ports)}")
    for kind in ("startupProbe", "livenessProbe", "readinessProbe"):
        probe = pod.main.get(kind)
        if probe is None:
            continue
        asked = probe.get("httpGet", probe.get("tcpSocket"))["port"]
        # A connection without a handshake is one that the coordinator counts as refused.
        served = "--metrics" if "httpGet" in probe else "--artifact-listen"
        if pod.port(asked) not in ports:
            problems.append(f"{kind} asks port {asked}, which is none")
        elif not option(pod.main, documents, served).endswith(f":{pod.port(asked)}"):
            problems.append(f"{kind} asks port {asked}, expected that of {served}")
    return problems


def _worker(pod: Pod, documents: list[dict], facts: Facts) -> list[str]:
    problems = []
    grace = int(option(pod.main, documents, "--stop-grace"))
    if pod.spec["terminationGracePeriodSeconds"] < grace + HAND_BACK_SECONDS:
        problems.append(f"is killed after {pod.spec['terminationGracePeriodSeconds']} s, with --stop-grace {grace}")
    limits = pod.main["resources"]["limits"]
    cache = next(volume["emptyDir"]["sizeLimit"] for volume in pod.spec["volumes"] if volume["name"] == "cache")
    kept = option(pod.main, documents, "--cache-size")
    if size(cache) < 1.1 * size(kept):
        problems.append(f"cache volume of {cache} is too small for --cache-size {kept}")
    if size(limits["ephemeral-storage"]) <= size(cache):
        problems.append(f"ephemeral storage of {limits['ephemeral-storage']} has no room for more than the cache")
    slots = int(option(pod.main, documents, "--slots"))
    if size(limits["memory"]) < WORKER_MEMORY + slots * facts.task_bytes:
        problems.append(f"{limits['memory']} of memory is too little for {slots} slots: a task of 1920x1080 takes "
                        f"{facts.task_bytes / 2**20:.0f} MiB by the cost model")
    return problems


def _selectors(documents: list[dict], pods: list[Pod]) -> list[str]:
    problems = []
    for pod in pods:
        selector = pod.owner["spec"].get("selector")
        if selector is not None and not _selects(selector, pod.labels):
            problems.append(f"{pod.name}: its selector does not select its own pods")
        governing = pod.owner["spec"].get("serviceName")
        if governing is not None and not any(
                service["metadata"]["name"] == governing and service["spec"].get("clusterIP") == "None"
                for service in of_kind(documents, "Service")):
            problems.append(f"{pod.name}: there is no headless service {governing}")
    for service in of_kind(documents, "Service"):
        name, selected = service["metadata"]["name"], [
            pod for pod in pods if _selects({"matchLabels": service["spec"]["selector"]}, pod.labels)]
        if len(selected) != 1:
            problems.append(f"service {name} selects {len(selected)} kinds of pods, expected 1")
        for port in service["spec"]["ports"]:
            problems += [f"service {name}: port {port['port']} leads to {port['targetPort']}, which {pod.name} has not"
                         for pod in selected if pod.port(port["targetPort"]) != port["port"]]
    for document in of_kind(documents, "PodDisruptionBudget"):
        if not any(_selects(document["spec"]["selector"], pod.labels) for pod in pods):
            problems.append(f"disruption budget {document['metadata']['name']} selects nothing")
    return problems


def _scaling(documents: list[dict], pods: list[Pod]) -> list[str]:
    problems = []
    for scaler in of_kind(documents, "ScaledObject") + of_kind(documents, "HorizontalPodAutoscaler"):
        target = scaler["spec"]["scaleTargetRef"]
        found = [pod for pod in pods if (pod.owner["apiVersion"], pod.owner["kind"], pod.name) == (
            target["apiVersion"], target["kind"], target["name"])]
        if len(found) != 1:
            problems.append(f"the autoscaler's target {target['name']} is not there")
            continue
        if "replicas" in found[0].owner["spec"]:
            problems.append(f"both the autoscaler and {target['name']} say how many replicas there are")
        per_worker = (scaler["spec"]["triggers"][0]["metadata"]["threshold"] if scaler["kind"] == "ScaledObject"
                      else scaler["spec"]["metrics"][0]["external"]["target"]["averageValue"])
        slots = option(found[0].main, documents, "--slots")
        if per_worker != slots:
            problems.append(f"the autoscaler counts {per_worker} slots a worker, it has {slots}")
    return problems


def _passes(documents: list[dict], direction: str, ends: tuple[Pod, Pod], port: int) -> bool:
    """Whether policies let `ends[0]` send to `ends[1]`: the first's for its Egress, or the second's for its Ingress."""
    own, other = ends if direction == "Egress" else (ends[1], ends[0])
    policies = [document["spec"] for document in of_kind(documents, "NetworkPolicy")
                if own.namespace == "depthfarm" and _selects(document["spec"]["podSelector"], own.labels)
                and direction in document["spec"]["policyTypes"]]
    for policy in policies:
        for rule in policy.get(direction.lower(), []):
            for peer in rule["from" if direction == "Ingress" else "to"]:
                names = {"kubernetes.io/metadata.name": other.namespace}
                near = ("namespaceSelector" in peer and _selects(peer["namespaceSelector"], names)) or (
                    "namespaceSelector" not in peer and other.namespace == "depthfarm")
                if near and _selects(peer.get("podSelector", {}), other.labels) and any(
                        allowed["port"] == port for allowed in rule["ports"]):
                    return True
    return not policies


def _network(documents: list[dict], pods: list[Pod]) -> list[str]:
    parts = {pod.labels["app.kubernetes.io/component"]: pod for pod in pods}
    stranger = Pod("a stranger", {}, {}, {})
    posing = Pod("a worker of another namespace", {}, parts["worker"].labels, {}, "elsewhere")
    monitoring = Pod("monitoring", {}, {}, {}, "monitoring")
    names = Pod("the name server", {}, {"k8s-app": "kube-dns"}, {}, "kube-system")
    coordinator, worker, submitter = parts["coordinator"], parts["worker"], parts["submitter"]
    farm_port = coordinator.port("farm")
    allowed = [(worker, coordinator, farm_port), (submitter, coordinator, farm_port), (worker, worker, ARTIFACT_PORT),
               (submitter, worker, ARTIFACT_PORT), (worker, submitter, UPLOAD_PORT), (monitoring, coordinator, METRICS_PORT),
               (worker, names, 53), (submitter, names, 53)]
    refused = [(end, target, port) for end in (stranger, posing) for target, port in (
        (coordinator, farm_port), (coordinator, METRICS_PORT), (worker, ARTIFACT_PORT), (submitter, UPLOAD_PORT))]
    refused += [(worker, coordinator, METRICS_PORT), (submitter, coordinator, METRICS_PORT),
                (monitoring, coordinator, farm_port), (worker, monitoring, 80), (worker, stranger, 80),
                (coordinator, stranger, 80), (coordinator, worker, ARTIFACT_PORT)]
    problems = []
    for wanted, connections in ((True, allowed), (False, refused)):
        for source, target, port in connections:
            passes = all(_passes(documents, direction, (source, target), port) for direction in ("Egress", "Ingress"))
            if passes != wanted:
                problems.append(f"{source.name} {'reaches' if passes else 'does not reach'} {target.name} at port {port}")
    return problems


def rule_problems(documents: list[dict], facts: Facts) -> list[str]:
    """What is wrong with a farm of these documents; they include a pod that submits."""
    pods = pods_of(documents)
    problems = _selectors(documents, pods) + _scaling(documents, pods) + _network(documents, pods)
    for pod in pods:
        of_pod = _restricted(pod) + _volumes(pod, documents, facts) + _options(pod, documents, facts)
        if not of_pod and pod.labels["app.kubernetes.io/component"] == "worker":
            of_pod = _worker(pod, documents, facts)
        problems += [f"{pod.name}: {problem}" for problem in of_pod]
    namespaces = of_kind(documents, "Namespace")
    if [entry["metadata"]["labels"].get("pod-security.kubernetes.io/enforce") for entry in namespaces] != ["restricted"]:
        problems.append("the namespace does not hold its pods to the restricted standard")
    return problems
