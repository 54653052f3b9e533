"""What pip and build call: setuptools, with its setup.py in this folder so that the top level stays the project's card."""

from setuptools.build_meta import _BuildMetaBackend


class _Backend(_BuildMetaBackend):
    def run_setup(self, setup_script="setup.py"):
        super().run_setup("demos/python/setup.py")


_backend = _Backend()
build_wheel = _backend.build_wheel
build_sdist = _backend.build_sdist
prepare_metadata_for_build_wheel = _backend.prepare_metadata_for_build_wheel


def get_requires_for_build_wheel(config_settings=None):
    return []


def get_requires_for_build_sdist(config_settings=None):
    return []
