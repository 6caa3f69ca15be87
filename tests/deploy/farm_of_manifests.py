"""The pods of a farm's documents as processes of this machine: their volumes are folders, their Secrets files as a kubelet
makes them, their commands those of the documents but for paths and ports. As root it runs them as the user they name."""

from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request
from pathlib import Path

from manifest_rules import Pod, arguments, pods_of

PATIENCE = 60.0  # seconds, on a machine that is busy
NOBODY = 65534


class FarmError(Exception):
    """A pod does not do what it should."""


def wait_for(what: str, condition, patience: float = PATIENCE):
    end = time.monotonic() + patience
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.05)
    raise FarmError(f"waited {patience:.0f} s for {what}")


class PodProcess:
    """One pod: its folders, and the process of its container."""

    def __init__(self, farm: Farm, pod: Pod) -> None:
        self.farm, self.pod = farm, pod
        self.folder = farm.work / pod.name
        self.log = farm.work / f"{pod.name}.log"
        self.process: subprocess.Popen | None = None
        self.places: dict[str, Path] = {}  # by path in the pod
        mounts = {mount["mountPath"]: mount["name"] for container in pod.spec["initContainers"] + pod.spec["containers"]
                  for mount in container["volumeMounts"]}
        volumes = {volume["name"]: volume for volume in pod.spec["volumes"]}
        for path, name in sorted(mounts.items()):
            volume = volumes.get(name, {})
            above = next((other for other in self.places if path.startswith(other + "/")), None)
            if above is not None:
                self.places[path] = self.places[above] / path.removeprefix(above + "/")
            else:
                self.places[path] = farm.projects if "persistentVolumeClaim" in volume else self.folder / name
            self.places[path].mkdir(parents=True, exist_ok=True)
            if "secret" in volume:
                self._make_secret(self.places[path], volume["secret"])
            else:
                self.places[path].chmod(0o777)  # an emptyDir's, or with fsGroup as good as that
        self._run_init_containers()

    def _make_secret(self, place: Path, secret: dict) -> None:
        """Files behind two links, which are exchanged when the Secret changes. With fsGroup the group may read them."""
        group = self.pod.spec["securityContext"].get("fsGroup")
        (place / "..now").mkdir()
        (place / "..data").symlink_to("..now")
        for name in self.farm.secrets[secret["secretName"]]:
            file = place / "..now" / name
            shutil.copyfile(self.farm.keys / name, file)
            file.chmod(secret["defaultMode"] | (0o440 if group is not None else 0))
            if self.farm.becomes_others and group is not None:
                os.chown(file, 0, group)
            (place / name).symlink_to(f"..data/{name}")

    def here(self, text: str) -> str:
        """A word of the pod's command as it is on this machine."""
        for path, place in sorted(self.places.items(), reverse=True):
            text = text.replace(path, str(place))
        # Of services and ports those that this farm has.
        text = text.replace("tcp://depthfarm-coordinator:7700", self.farm.endpoint)
        text = re.sub(r"(tcp://\*|=0\.0\.0\.0):\d+", lambda match: match[1].replace("0.0.0.0", "127.0.0.1").replace(
            "tcp://*", "tcp://127.0.0.1") + ":*", text)
        return text.replace("{metadata.name}", f"{self.pod.name}-0").replace("{status.podIP}", "127.0.0.1")

    def _run_init_containers(self) -> None:
        for container in self.pod.spec["initContainers"]:
            done = subprocess.run([self.here(word) for word in container["command"]], capture_output=True, text=True,
                                  check=False, **self.farm.user_of(self.pod))
            if done.returncode != 0:
                raise FarmError(f"{self.pod.name}: {container['name']} ends with {done.returncode}: {done.stderr}")

    def command(self) -> list[str]:
        program, *rest = [self.here(word) for word in arguments(self.pod.main, self.farm.documents)]
        return [str(self.farm.programs / program), *rest]

    def start(self) -> None:
        with self.log.open("w") as log:
            # A terminal may be there, a pod has none; and its home is nobody's. Sanitizers keep their options.
            kept = {name: value for name, value in os.environ.items() if name == "PATH" or name.endswith("SAN_OPTIONS")}
            self.process = subprocess.Popen(self.command(), stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                            env=kept, **self.farm.user_of(self.pod))

    def said(self, pattern: str) -> str:
        """What follows `pattern`, a group of it, in what it wrote; waits for it."""
        def look() -> str | None:
            found = re.search(pattern, self.log.read_text(), re.MULTILINE)
            if not found and self.process.poll() is not None:
                raise FarmError(f"{self.pod.name} ended with {self.process.returncode}: {self.log.read_text()}")
            return found[1] if found else None
        try:
            return wait_for(f"{self.pod.name} to say {pattern}", look)
        except FarmError as error:
            raise FarmError(f"{error}\n{self.log.read_text()}") from error

    def probe_problems(self, addresses: dict[int, str]) -> list[str]:
        """Asks as a kubelet does; `addresses` are HOST:PORT here by port of the pod."""
        problems = []
        for kind in ("startupProbe", "livenessProbe", "readinessProbe"):
            probe = self.pod.main.get(kind, {})
            try:
                if "httpGet" in probe:
                    address = addresses[self.pod.port(probe["httpGet"]["port"])]
                    urllib.request.urlopen(f"http://{address}{probe['httpGet']['path']}", timeout=10).close()
                elif probe:
                    host, _, port = addresses[self.pod.port(probe["tcpSocket"]["port"])].rpartition(":")
                    socket.create_connection((host, int(port)), timeout=10).close()
            except (OSError, KeyError, urllib.error.HTTPError) as error:
                problems.append(f"{self.pod.name}: {kind} is not answered: {error}")
        return problems

    def ends(self) -> int:
        return self.process.wait(timeout=PATIENCE)


class Farm:
    """A folder for all pods. Use it in a `with`, which ends what was started."""

    def __init__(self, documents: list[dict], secrets: dict[str, set[str]], programs: Path, work: Path) -> None:
        self.documents, self.secrets, self.programs, self.work = documents, secrets, programs, work
        self.endpoint = ""
        self.keys = work / "farm-keys"
        self.projects = work / "projects"
        self.projects.mkdir()
        subprocess.run([programs / "depthfarm", "keygen", "-o", self.keys], check=True, stdout=subprocess.DEVNULL)
        self.pods: list[PodProcess] = []
        work.chmod(0o755)
        self.becomes_others = os.geteuid() == 0 and self._may_run_as(NOBODY)

    def _may_run_as(self, user: int) -> bool:
        """Whether others reach the programs at all: a build may be in a folder that is closed to them."""
        try:
            subprocess.run([self.programs / "depthfarm", "--version"], check=True, stdout=subprocess.DEVNULL, user=user)
        except (OSError, subprocess.CalledProcessError):
            print(f"user {user} does not reach {self.programs}: pods run as who runs the test")
            return False
        return True

    def user_of(self, pod: Pod) -> dict:
        security = pod.spec["securityContext"]
        if not self.becomes_others:
            return {}
        return {"user": security["runAsUser"], "group": security["runAsGroup"],
                "extra_groups": [security["fsGroup"]] if "fsGroup" in security else []}

    def pod(self, component: str) -> PodProcess:
        found = next(pod for pod in pods_of(self.documents) if pod.labels["app.kubernetes.io/component"] == component)
        self.pods.append(PodProcess(self, found))
        return self.pods[-1]

    def __enter__(self) -> Farm:
        return self

    def __exit__(self, *_: object) -> None:
        for pod in self.pods:
            if pod.process is not None and pod.process.poll() is None:
                pod.process.kill()
                pod.process.wait()
