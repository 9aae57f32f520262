"""Every direct and system command of the NXT, one declaration each, by theme."""
