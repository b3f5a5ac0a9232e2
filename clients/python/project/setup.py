"""A wheel with the module _rig is of this interpreter and machine, and brings the files that rigs are built from. The sdist,
and what is made of it, has neither: the client and the reader of recordings."""
import pathlib

import setuptools

HERE = pathlib.Path(__file__).resolve().parent
HAS_RIG = any(HERE.glob("wholehand/_rig*.so"))


class Distribution(setuptools.Distribution):
    def has_ext_modules(self):
        return HAS_RIG


def shipped():
    """Files for the folder share/wholehand of the environment, by folder."""
    folders = {}
    for file in sorted((*HERE.glob("share/wholehand/config/**/*"), *HERE.glob("share/wholehand/data/**/*"))):
        if file.is_file():
            relative = file.relative_to(HERE)
            folders.setdefault(str(relative.parent), []).append(str(relative))
    return list(folders.items())


setuptools.setup(distclass=Distribution, data_files=shipped() if HAS_RIG else [])
