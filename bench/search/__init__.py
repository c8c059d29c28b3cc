"""The search for smaller networks: error on unseen links against counted cycles and flash."""
