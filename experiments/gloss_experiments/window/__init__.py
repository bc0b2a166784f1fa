"""What the observer sees: PsychoPy's window, the screens in it, where things stand."""
