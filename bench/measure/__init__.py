"""The benchmark harness's measuring side: accuracy, latency, memory, energy."""
