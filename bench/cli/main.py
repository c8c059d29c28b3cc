"""The `bench` command group: lazy subcommands, and errors as one line."""

from __future__ import annotations

import sys
from functools import wraps
from importlib import import_module
from typing import Any

import click

from bench import __version__
from bench.cli.console import foreign_prints_to_stderr
from bench.cli.failing import ended_with, open_streams
from bench.errors import unknown_name

COMMANDS = {
    "run": "Benchmark models on backends: error, latency, size, energy.",
    "transfer": "Train on each data set, test on each other: what carries over.",
    "export": "Write a fitted model as C for a microcontroller, or as ONNX.",
    "count": "Count what a network takes on a microcontroller, in an emulator.",
    "search": "Search for smaller networks: error against counted cycles and flash.",
    "leaderboard": "Rebuild the Markdown leaderboard from result files.",
    "compare": "Compare two result folders or two runs on the same rows.",
    "history": "Say what changed between versions of code and packages.",
    "site": "Write one self-contained page of all results.",
    "models": "List the mitigation models.",
    "backends": "List the backends a model can run on.",
    "devices": "List the device profiles and what their figures rest on.",
    "simulate": "Simulate recordings from a simulator's TOML and a geometry.",
    "data": "List, describe, import and fetch recordings.",
    "diagnose": "Find, name and model what a simulator leaves out of recordings.",
    "effects": "List the effects that a diagnosis names, and what each stands on.",
    "plan": "Say which measurement tells apart what a diagnosis cannot.",
    "worth": "Say how many links must be surveyed, with and without a diagnosis.",
    "challenge": "Hide physics from the diagnosis and score what it says.",
    "reproduce": "Redo the paper's tables and figures on any recordings.",
    "plugin": "Start a plug-in package of your own.",
    "doctor": "Say what this machine has, what is missing and how to get it.",
}


class LazyGroup(click.Group):
    """Knows every subcommand's name and one-line help; imports a subcommand when it is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the subcommands in the order of the help."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import one subcommand. Raises BenchError with a did-you-mean."""
        if cmd_name not in COMMANDS:
            raise unknown_name("command", cmd_name, COMMANDS)
        command: click.Command = import_module(f"bench.cli.{cmd_name}").command
        _keep_stdout(command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands' one-line help without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Example: bench run --model remnet --backend int8",
)
@click.version_option(__version__, prog_name="bench")
@click.option(
    "--traceback",
    is_flag=True,
    expose_value=False,
    help="Show where a failure came from; may stand anywhere on the line.",
)
def group() -> None:
    """Benchmark ultra-wideband range-error mitigation.

    Which model, at which precision, on which device - for what error, latency, size and energy?
    """


_QUIET: set[Any] = set()


def _keep_stdout(command: click.Command) -> None:
    """Have whatever a command's code does not print itself go to standard error."""
    for inner in getattr(command, "commands", {}).values():
        _keep_stdout(inner)
    work = command.callback
    if work is not None and work not in _QUIET:
        command.callback = _quietly(work)
        _QUIET.add(command.callback)


def _quietly(work: Any) -> Any:
    @wraps(work)
    def wrapped(*args: Any, **kwargs: Any) -> Any:
        with foreign_prints_to_stderr():
            return work(*args, **kwargs)

    return wrapped


def main() -> None:
    """Run the command line; any failure ends in one line on stderr and exit code 2."""
    arguments = sys.argv[1:]
    plain = [word for word in arguments if word != "--traceback"]
    open_streams()
    code = ended_with(
        lambda: group.main(plain, prog_name="bench", standalone_mode=False),
        traceback=plain != arguments,
    )
    sys.exit(code)
