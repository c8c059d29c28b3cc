"""The `bench` command group: lazy subcommands, and errors as one line."""

from __future__ import annotations

import os
import sys
from importlib import import_module

import click

from bench import __version__
from bench.errors import BenchError, unknown_name

COMMANDS = {
    "run": "Benchmark models on backends: error, latency, size, energy.",
    "transfer": "Train on each data set, test on each other: what carries over.",
    "export": "Write a fitted model as C for a microcontroller, or as ONNX.",
    "count": "Count what a network takes on a microcontroller, in an emulator.",
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
def group() -> None:
    """Benchmark ultra-wideband range-error mitigation.

    Which model, at which precision, on which device - for what error, latency, size and energy?
    """


def main() -> None:
    """Run the command line; bad input ends in one line on stderr and exit code 2."""
    try:
        code = group.main(standalone_mode=False)
    except BenchError as error:
        click.echo(f"bench: {error}", err=True)
        code = 2
    except click.ClickException as error:
        error.show()
        code = 2
    except (KeyboardInterrupt, click.Abort):
        click.echo("bench: interrupted; finished runs are kept", err=True)
        code = 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    sys.exit(code)
