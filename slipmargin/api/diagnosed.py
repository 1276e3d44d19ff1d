"""What every diagnosis writes: a folder of files, the corrected robot, the report."""

from __future__ import annotations

from pathlib import Path

from slipmargin.api.result import Result


class Diagnosed(Result):
    """Base of the results of a diagnosis."""

    __slots__ = ()

    def corrected_text(self) -> str:
        """The corrected robot file as TOML text."""
        raise NotImplementedError

    def files(self) -> dict[str, str | bytes]:
        """File name → content of everything that a diagnosis writes."""
        raise NotImplementedError

    def write(self, path: Path | str) -> None:
        """Write ``.toml`` (the corrected robot), ``.json`` (the report) or a picture.

        Raises
        ------
        InputError
            For another ending, or where the file cannot be written.
        """
        if Path(path).suffix.lower() == ".toml":
            self.write_files(texts={path: self.corrected_text()})
        else:
            Result.write(self, path)

    def write_folder(self, folder: Path | str) -> list[str]:
        """Write :meth:`files` into a folder, all or none, and return their names.

        Raises
        ------
        InputError
            Where the folder cannot be written; then nothing has changed.
        """
        from slipmargin.io.folder import write_folder

        files = self.files()
        write_folder(folder, files)
        return list(files)
