"""The manifests of deploy/kubernetes: against the API's schemas, each other, the programs' options and the cost model; and
their pods as processes that work together.
usage: kubernetes_test.py SOURCE-FOLDER PROGRAM-FOLDER     exit code 77: python3-kubernetes is not here"""

from __future__ import annotations

import copy
import json
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import urllib.request
from collections.abc import Callable
from pathlib import Path

try:
    from kubernetes_schema import schema_problems
except ImportError as error:
    print(f"skipped: {error}; python3-kubernetes is not installed")
    sys.exit(77)

from farm_of_manifests import Farm, FarmError, wait_for
from kustomization import MERGE_KEYS, ManifestError, build, files_of, identity, load, merged
from manifest_rules import Facts, of_kind, pods_of, rule_problems

SOURCE, PROGRAMS = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
MANIFESTS = SOURCE / "deploy/kubernetes"
OVERLAYS = sorted(folder.name for folder in (MANIFESTS / "overlays").iterdir())
SUBMIT = MANIFESTS / "examples/submit.yaml"


def farm_of(folder: str) -> list[dict]:
    """A farm and a pod that submits to it."""
    return build(MANIFESTS / folder) + load(SUBMIT)


def run(*command: str | Path) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def secrets_of_readme() -> dict[str, set[str]]:
    """Files by Secret, as the runbook has them made; `\\` joins its lines."""
    text = (SOURCE / "deploy/README.md").read_text().replace("\\\n", " ")
    made = re.findall(r"create secret generic (\S+)((?: +--from-file=\S+)+)", text)
    return {name: {Path(file.partition("=")[2]).name for file in files.split()} for name, files in made}


def largest_task_bytes(work: Path) -> int:
    """What the cost model predicts for one frame of eight views of 1920x1080 with default options."""
    run(PROGRAMS / "depthfarm", "scene", "arc", "-o", work / "small", "--cameras", "8", "--size", "64x36")
    sequence = json.loads((work / "small/sequence.json").read_text())
    folder = work / "large"
    folder.mkdir()
    for camera in sequence["cameras"]:
        scale = 1920 / camera["width"]
        matrix = camera["K"]
        camera |= {"width": 1920, "height": 1080, "format": "yuv420p8", "images": [f"{camera['name']}.yuv"],
                   "K": [[matrix[0][0] * scale, 0, 959.5], [0, matrix[1][1] * scale, 539.5], [0, 0, 1]]}
        with (folder / camera["images"][0]).open("wb") as picture:
            picture.truncate(1920 * 1080 * 3 // 2)
    (folder / "sequence.json").write_text(json.dumps({key: sequence[key] for key in ("name", "zNear", "zFar", "cameras")}))
    plan = json.loads(run(PROGRAMS / "depthfarm", "plan", folder / "sequence.json", "--json"))
    return max(stage["peakMemoryBytes"] for stage in plan["stages"])


def facts() -> Facts:
    programs = {"depthfarm-coordinator": [], "depthfarm-worker": [], "depthfarm submit": ["submit"]}
    helps = {name: run(PROGRAMS / name.split()[0], *rest, "--help") for name, rest in programs.items()}
    options = {name: set(re.findall(r"^  (?:-\w,)?(--[a-z-]+)", text, re.MULTILINE)) for name, text in helps.items()}
    with tempfile.TemporaryDirectory() as work:
        return Facts(secrets_of_readme(), options, largest_task_bytes(Path(work)))


FACTS = facts()


def problems(documents: list[dict]) -> list[str]:
    found = [problem for document in documents for problem in schema_problems(document)]
    return found or rule_problems(documents, FACTS)


def document(documents: list[dict], kind: str, name: str) -> dict:
    return next(entry for entry in of_kind(documents, kind) if entry["metadata"]["name"] == name)


class Manifests(unittest.TestCase):
    def test_every_farm_is_as_the_api_and_the_programs_want_it(self) -> None:
        self.assertGreaterEqual(FACTS.task_bytes, 100 * 2**20)
        for folder in ("base", *(f"overlays/{name}" for name in OVERLAYS)):
            self.assertEqual(problems(farm_of(folder)), [], folder)

    def test_every_file_is_part_of_a_farm(self) -> None:
        used = set().union(*(files_of(MANIFESTS / "overlays" / name) for name in OVERLAYS)) | {SUBMIT}
        self.assertEqual(used, {file.resolve() for file in MANIFESTS.rglob("*") if file.is_file()})

    def test_a_real_kustomize_makes_the_same(self) -> None:
        tool = next((command for command in (["kustomize", "build"], ["kubectl", "kustomize"]) if shutil.which(command[0])),
                    None)
        version = "" if tool is None else run(tool[0], "version", *(["--client"] if tool[0] == "kubectl" else []))
        if tool is None or not re.search(r"\bv[4-9]\.", version):  # older ones do not know today's files
            self.skipTest("no kustomize of version 4 or later here: overlays were applied by kustomization.py alone")

        def sorted_lists(value: object, field: str = "") -> object:
            if isinstance(value, dict):
                return {key: sorted_lists(entry, key) for key, entry in value.items()}
            if isinstance(value, list):
                elements = [sorted_lists(element) for element in value]
                return sorted(elements, key=lambda element: element[MERGE_KEYS[field]]) if field in MERGE_KEYS else elements
            return value

        for name in OVERLAYS:
            with tempfile.TemporaryDirectory() as work:
                file = Path(work) / "made.yaml"
                file.write_text(run(*tool, MANIFESTS / "overlays" / name))
                real = sorted(load(file), key=identity)
            ours = sorted(build(MANIFESTS / "overlays" / name), key=identity)
            self.assertEqual(sorted_lists(ours), sorted_lists(real), name)

    def test_a_number_of_workers_is_no_longer_given_where_they_are_scaled(self) -> None:
        for name in ("autoscaled", "autoscaled-hpa"):
            worker = document(farm_of(f"overlays/{name}"), "Deployment", "depthfarm-worker")
            self.assertNotIn("replicas", worker["spec"])

    def test_images_and_their_user_are_those_of_the_containerfile(self) -> None:
        container = SOURCE / "deploy/container"
        stages = set(re.findall(r"install.sh (\S+)$", (container / "Containerfile").read_text(), re.MULTILINE))
        version = re.search(r"^project\(depthfarm VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
        user = int(re.search(r"^user=(\d+)$", (container / "install.sh").read_text(), re.MULTILINE)[1])
        self.assertIn(f"USER {user}:{user}\n", (container / "Containerfile").read_text())
        used = set()
        for name in OVERLAYS:
            for pod in pods_of(farm_of(f"overlays/{name}")):
                used |= {container["image"] for container in pod.spec["initContainers"] + pod.spec["containers"]}
                self.assertEqual(pod.spec["securityContext"]["runAsUser"], user, pod.name)
        self.assertEqual(used, {f"{stage}:{version}" for stage in stages})

    def test_the_submitters_port_is_the_readmes(self) -> None:
        self.assertIn("--upload-listen 'tcp://*:7702'", (SOURCE / "deploy/README.md").read_text())


class Mutants(unittest.TestCase):
    """Each change below is a mistake that must be found, by what it says."""

    def refused(self, said: str, change: Callable[[list[dict]], None], folder: str = "base") -> None:
        documents = copy.deepcopy(farm_of(folder))
        change(documents)
        found = problems(documents)
        self.assertTrue(any(said in problem for problem in found), f"expected '{said}' among {found}")

    def changed(self, said: str, kind: str, name: str, patch: dict, folder: str = "base") -> None:
        def change(documents: list[dict]) -> None:
            index = documents.index(document(documents, kind, name))
            documents[index] = merged(documents[index], patch)
        self.refused(said, change, folder)

    def worker(self, said: str, pod: dict, container: dict | None = None, folder: str = "base") -> None:
        spec = pod | ({"containers": [{"name": "worker"} | container]} if container else {})
        self.changed(said, "Deployment", "depthfarm-worker", {"spec": {"template": {"spec": spec}}}, folder)

    def coordinator(self, said: str, container: dict) -> None:
        self.changed(said, "StatefulSet", "depthfarm-coordinator",
                     {"spec": {"template": {"spec": {"containers": [{"name": "coordinator"} | container]}}}})

    def argument(self, said: str, old: str, new: str, component: str = "worker", folder: str = "base") -> None:
        kind = {"worker": "Deployment", "coordinator": "StatefulSet"}[component]

        def change(documents: list[dict]) -> None:
            container = document(documents, kind, f"depthfarm-{component}")["spec"]["template"]["spec"]["containers"][0]
            self.assertIn(old, container["args"])
            container["args"] = [new if word == old else word for word in container["args"]]
        self.refused(said, change, folder)

    def test_against_the_schemas(self) -> None:
        self.worker("nodeSelektor is not known", {"nodeSelektor": {"a": "b"}})
        self.worker("expected int", {"terminationGracePeriodSeconds": "150"})
        self.worker("expected bool", {"automountServiceAccountToken": "false"})
        self.worker("expected a quantity", {}, {"resources": {"limits": {"memory": "6GiB"}}})
        self.changed("`template`, must not be `None`", "Deployment", "depthfarm-worker", {"spec": {"template": None}})
        self.changed("expected one of", "NetworkPolicy", "deny-by-default", {"spec": {"policyTypes": ["ingress"]}})
        self.changed("expected str", "ConfigMap", "depthfarm-options", {"data": {"STOP_GRACE": 120}})
        self.changed("is not known", "ScaledObject", "depthfarm-worker", {"spec": {"maxReplicas": 3}}, "overlays/autoscaled")
        self.changed("is not known", "HorizontalPodAutoscaler", "depthfarm-worker", {"spec": {"maxReplicaCount": 3}},
                     "overlays/autoscaled-hpa")

    def test_against_each_other(self) -> None:
        self.changed("does not select its own pods", "Deployment", "depthfarm-worker",
                     {"spec": {"selector": {"matchLabels": {"app.kubernetes.io/component": "workers"}}}})
        self.changed("selects 0 kinds of pods", "Service", "depthfarm-coordinator",
                     {"spec": {"selector": {"app.kubernetes.io/component": "coordinators"}}})
        self.changed("which depthfarm-coordinator has not", "Service", "depthfarm-coordinator",
                     {"spec": {"ports": [{"name": "farm", "port": 7700, "targetPort": "frm"}]}})
        self.changed("no headless service", "StatefulSet", "depthfarm-coordinator", {"spec": {"serviceName": "coordinator"}})
        self.changed("disruption budget depthfarm-worker selects nothing", "PodDisruptionBudget", "depthfarm-worker",
                     {"spec": {"selector": {"matchLabels": {"app.kubernetes.io/component": "workers"}}}})
        self.worker("makes no Secret farm-keys", {"volumes": [{"name": "secret", "secret": {"secretName": "farm-keys"}}]})
        self.worker("no claim films", {"volumes": [{"name": "projects", "persistentVolumeClaim": {"claimName": "films"}}]})
        self.worker("no ConfigMap options", {}, {"envFrom": [{"configMapRef": {"name": "options"}}]})
        self.worker("mounts tmp, which is no volume", {}, {"volumeMounts": [{"name": "tmp", "mountPath": "/tmp"}]})
        self.worker("nobody mounts tmp", {"volumes": [{"name": "tmp", "emptyDir": {}}]})
        self.changed("say how many replicas", "Deployment", "depthfarm-worker", {"spec": {"replicas": 4}},
                     "overlays/autoscaled")
        self.worker("counts 4 slots a worker", {}, {"resources": {"requests": {"cpu": "3"}}}, "overlays/autoscaled")
        self.worker("counts 4 slots a worker", {}, {"resources": {"requests": {"cpu": "3"}}}, "overlays/autoscaled-hpa")
        self.changed("target depthfarm is not there", "ScaledObject", "depthfarm-worker",
                     {"spec": {"scaleTargetRef": {"name": "depthfarm"}}}, "overlays/autoscaled")

    def test_against_the_programs(self) -> None:
        self.argument("has no option --slot", "--slots=$(SLOTS)", "--slot=$(SLOTS)")
        self.argument("no such variable", "--slots=$(SLOTS)", "--slots=$(SLOT)")
        self.argument("has no option --jobs", "--keep-jobs=$(KEEP_JOBS)", "--jobs=$(KEEP_JOBS)", "coordinator")
        self.argument("none of its ports", "--listen=tcp://*:7700", "--listen=tcp://*:7000", "coordinator")
        self.argument("expected that of --metrics", "--metrics=0.0.0.0:9470", "--metrics=0.0.0.0:7700", "coordinator")
        self.coordinator("expected that of --artifact-listen",
                         {"livenessProbe": {"httpGet": None, "tcpSocket": {"port": "farm"}}})
        self.coordinator("which is none", {"readinessProbe": {"httpGet": {"path": "/healthz", "port": "health"}}})
        self.worker("is killed after 130 s", {"terminationGracePeriodSeconds": 130})
        self.changed("too small for --cache-size", "ConfigMap", "depthfarm-options", {"data": {"CACHE_SIZE": "60GB"}})
        self.worker("no room for more", {}, {"resources": {"limits": {"ephemeral-storage": "60Gi"}}})
        self.worker("is too little for 4 slots", {}, {"resources": {"limits": {"memory": "4Gi"}}})
        self.worker("is too little for 1 slots", {}, {"resources": {"limits": {"memory": "2Gi"}}}, "overlays/local")

    def test_against_the_rules_of_security(self) -> None:
        self.worker("may run as root", {"securityContext": {"runAsUser": 0}})
        self.worker("may run as root", {"securityContext": {"runAsNonRoot": None}})
        self.worker("no seccomp profile", {"securityContext": {"seccompProfile": None}})
        self.worker("token", {"automountServiceAccountToken": None})
        self.worker("host's namespaces", {"hostNetwork": True})
        for field, said in (("allowPrivilegeEscalation", "gain privileges"), ("readOnlyRootFilesystem", "write to its root"),
                            ("capabilities", "keeps capabilities")):
            self.worker(said, {}, {"securityContext": {field: None}})
            self.worker(said, {"initContainers": [{"name": "keys", "securityContext": {field: None}}]})
        self.worker("no bound of memory", {}, {"resources": {"limits": {"memory": None}}})
        self.changed("restricted", "Namespace", "depthfarm",
                     {"metadata": {"labels": {"pod-security.kubernetes.io/enforce": "baseline"}}})

    def test_of_the_network(self) -> None:
        for name in ("deny-by-default", "depthfarm-coordinator", "depthfarm-worker", "depthfarm-submitter"):
            self.refused("reach", lambda documents, name=name: documents.remove(document(documents, "NetworkPolicy", name)))

        def open_to_all(documents: list[dict]) -> None:
            policy = document(documents, "NetworkPolicy", "depthfarm-coordinator")
            policy["spec"]["ingress"][1]["from"] = [{"namespaceSelector": {}}]
        self.refused("reaches depthfarm-coordinator at port 9470", open_to_all)
        self.changed("depthfarm-worker does not reach depthfarm-coordinator", "NetworkPolicy", "depthfarm-coordinator",
                     {"spec": {"ingress": [{"from": [{"podSelector": {}}], "ports": [{"protocol": "TCP", "port": 7000}]}]}})

    def test_of_the_files(self) -> None:
        with tempfile.TemporaryDirectory() as work:
            copy_of = Path(work) / "kubernetes"
            for said, file, old, new in (
                    ("replicas is given twice", "base/worker.yaml", "  replicas: 4\n", "  replicas: 4\n  replicas: 5\n"),
                    ("not known here", "base/kustomization.yaml", "images:", "configMapGenerator: []\nimages:"),
                    ("no apps/v1 Deployment worker", "overlays/local/small.yaml", "name: depthfarm-worker", "name: worker"),
                    ("No such file", "base/kustomization.yaml", "- worker.yaml", "- workers.yaml")):
                shutil.copytree(MANIFESTS, copy_of)
                text = (copy_of / file).read_text()
                self.assertIn(old, text)
                (copy_of / file).write_text(text.replace(old, new, 1))
                with self.assertRaisesRegex(ManifestError, said):
                    build(copy_of / "overlays/local")
                shutil.rmtree(copy_of)


class Processes(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = Path(folder.name)

    def farm(self, documents: list[dict]) -> Farm:
        farm = Farm(documents, FACTS.secrets, PROGRAMS, self.work)
        self.addCleanup(farm.__exit__)
        return farm

    def test_the_pods_of_a_farm_do_a_job(self) -> None:
        farm = self.farm(farm_of("overlays/local"))
        coordinator = farm.pod("coordinator")
        coordinator.start()
        farm.endpoint = coordinator.said(r"^listening on (.+)$")
        metrics = coordinator.said("^metrics at http://(.+)/metrics$")
        self.assertEqual(coordinator.probe_problems({9470: metrics}), [])
        worker = farm.pod("worker")
        worker.start()
        worker.said("(welcomed)")
        self.assertEqual(worker.probe_problems({7701: worker.said("artifacts=tcp://(.+?) ")}), [])
        self.assertTrue((coordinator.folder / "journal/coordinator.sqlite").exists())

        run(PROGRAMS / "depthfarm", "scene", "arc", "-o", farm.projects / "studio", "--cameras", "3", "--size", "64x48")
        submit = farm.pod("submitter")
        submit.start()
        self.assertEqual(submit.ends(), 0, submit.log.read_text())
        self.assertTrue((farm.projects / "studio-depth/depth.json").exists())

        # What autoscalers and Prometheus are told to ask for.
        def with_the_worker() -> str | None:
            with urllib.request.urlopen(f"http://{metrics}/metrics", timeout=10) as answer:
                published = answer.read().decode()
            return published if "\ndepthfarm_slots 1\n" in published else None
        text = wait_for("the worker's slot among the metrics", with_the_worker)
        asked = set()
        for name in OVERLAYS:
            for scaler in of_kind(farm_of(f"overlays/{name}"), "ScaledObject"):
                asked |= set(re.findall(r"depthfarm_\w+", scaler["spec"]["triggers"][0]["metadata"]["query"]))
            for scaler in of_kind(farm_of(f"overlays/{name}"), "HorizontalPodAutoscaler"):
                asked.add(scaler["spec"]["metrics"][0]["external"]["metric"]["name"])
        self.assertGreaterEqual(len(asked), 1)
        self.assertLessEqual(asked, set(re.findall(r"^(depthfarm_\w+)", text, re.MULTILINE)))

        # Probes of nobody are found unanswered.
        wrong = copy.deepcopy(coordinator.pod.main["livenessProbe"])
        coordinator.pod.main["livenessProbe"]["httpGet"]["path"] = "/health"
        self.assertRegex(str(coordinator.probe_problems({9470: metrics})), "livenessProbe is not answered.*404")
        coordinator.pod.main["livenessProbe"] = wrong

        # The Secret loses the submitter's key: told to read again, the coordinator sees it through its link.
        secret = coordinator.places["/run/depthfarm/secret"]
        lines = (secret / "authorized").read_text().splitlines(keepends=True)
        (secret / "..then").mkdir()
        for file in (secret / "..now").iterdir():
            shutil.copyfile(file, secret / "..then" / file.name)
        (secret / "..then/authorized").write_text("".join(line for line in lines if not line.startswith("admin")))
        (secret / "..next").symlink_to("..then")
        (secret / "..next").replace(secret / "..data")
        coordinator.process.send_signal(signal.SIGHUP)
        coordinator.said("(keys_reread)")

        worker.process.send_signal(signal.SIGTERM)
        self.assertEqual(worker.ends(), 0)
        self.assertIn("stop_asked finish_ms=30000", worker.log.read_text())
        coordinator.process.send_signal(signal.SIGTERM)
        self.assertEqual(coordinator.ends(), 0)

    def test_a_worker_with_roots_reaches_its_keys(self) -> None:
        farm = self.farm(farm_of("overlays/local"))
        coordinator, worker = farm.pod("coordinator"), farm.pod("worker")
        coordinator.start()
        farm.endpoint = coordinator.said(r"^listening on (.+)$")
        worker.pod.main["args"].append("--write-root=/srv/depthfarm")
        worker.start()
        if worker.said("(welcomed|Landlock)") == "Landlock":
            self.skipTest("this kernel has no Landlock")
        worker.process.send_signal(signal.SIGHUP)
        worker.said("(keys_reread)")

    def test_keys_are_not_taken_as_a_secret_volume_has_them(self) -> None:
        documents = farm_of("base")
        pod = document(documents, "StatefulSet", "depthfarm-coordinator")["spec"]["template"]["spec"]
        pod["containers"][0]["args"] = [word.replace("/run/depthfarm", "/run/depthfarm/secret")
                                        for word in pod["containers"][0]["args"]]
        coordinator = self.farm(documents).pod("coordinator")
        coordinator.start()
        self.assertEqual(coordinator.ends(), 2)
        self.assertIn("is open to group or others", coordinator.log.read_text())

    def test_a_secret_that_lacks_a_file_keeps_the_pod_from_starting(self) -> None:
        documents = farm_of("base")
        farm = self.farm(documents)
        farm.secrets = {name: files - {"worker.key"} for name, files in farm.secrets.items()}
        with self.assertRaisesRegex(FarmError, "keys ends with 1.*worker.key"):
            farm.pod("worker")

    def test_a_misspelt_option_keeps_the_worker_from_starting(self) -> None:
        documents = farm_of("base")
        pod = document(documents, "Deployment", "depthfarm-worker")["spec"]["template"]["spec"]
        pod["containers"][0]["args"].append("--grace=1")
        farm = self.farm(documents)
        farm.endpoint = "tcp://127.0.0.1:7700"
        worker = farm.pod("worker")
        worker.start()
        with self.assertRaisesRegex(FarmError, "ended with 2"):
            worker.said("(welcomed)")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
